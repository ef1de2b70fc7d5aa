"""Claims of what makes IWHO better than WHO, and of its stability, each verdict by a rule on numbers."""

from seatrial.core.results import Claim, Verdict
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.qi2025.ablation import HerdVariant
from seatrial_studies.qi2025.evidence import WildHorseEvidence, percent_text
from seatrial_studies.qi2025.published import SearchAlgorithm
from seatrial_studies.qi2025.reproduction import SearchSetting
from seatrial_studies.qi2025.search_claims import OWN_SETTING, judged_in_settings
from seatrial_studies.sign_test import is_smaller

_ADDITIONS = {
    HerdVariant.NO_FLUCTUATION: "Random fluctuation of 5 % of the horses improves the search (section 2.2)",
    HerdVariant.NO_INERTIA: "The dynamic inertia weight improves the search (section 2.3)",
    HerdVariant.NO_COMPETITION: "The competition for the waterhole improves the search (section 2.3)",
}


def claims(evidence: WildHorseEvidence) -> tuple[Claim, ...]:
    """What the paper says of its three additions, and of stability."""
    return (*(addition_claim(evidence, variant) for variant in _ADDITIONS), stability_claim(evidence))


def addition_claim(evidence: WildHorseEvidence, variant: HerdVariant) -> Claim:
    """By sign tests on runs in the same seas and boxes, with the addition and without."""
    own, elsewhere = SearchSetting.PAPER, SearchSetting.WHOLE_OFF_CENTRE
    complete, without = (evidence.ablation.run_errors(own, v) for v in (None, variant))
    texts = {s: _compared_text(evidence, s, variant) for s in (own, elsewhere)}
    text = (
        f"{evidence.ablation_runs} runs at each heading of 90/135/180°. In the chosen setting {texts[own]}; with the "
        "whole record (eq. 27) and a box off centre "
        f"{texts[elsewhere]}"
    )
    claim = _ADDITIONS[variant]
    if is_smaller(complete, without):
        if is_smaller(*(evidence.ablation.run_errors(elsewhere, v) for v in (None, variant))):
            return Claim(claim, Verdict.CONFIRMED, text)
        return Claim(claim, Verdict.HOLDS_IN_OWN_SETTING, text, OWN_SETTING)
    return Claim(claim, Verdict.REFUTED if is_smaller(without, complete) else Verdict.UNKNOWABLE, text)


def _compared_text(evidence: WildHorseEvidence, setting: SearchSetting, variant: HerdVariant) -> str:
    complete, without = (evidence.ablation.run_errors(setting, v) for v in (None, variant))
    return (
        f"IWHO is {percent_text(evidence.ablation.mean_errors(setting, None))} off, "
        f"{percent_text(evidence.ablation.mean_errors(setting, variant))} {variant} (better with it in "
        f"{int((complete < without).sum())} of {complete.size} runs, worse in {int((complete > without).sum())})"
    )


def stability_claim(evidence: WildHorseEvidence) -> Claim:
    """Held where the values scatter least over the runs of IWHO at every heading."""
    own, elsewhere = SearchSetting.PAPER, SearchSetting.WHOLE_OFF_CENTRE
    return judged_in_settings(
        "IWHO identifies more stably than the other two",
        "standard deviation of the values over the runs, relative to the truth, mean over the coefficients, at "
        f"90/135/180°: in the chosen setting {_scatter_text(evidence, own)} ({evidence.run_count(own)} runs each); "
        f"with the whole record and a box off centre {_scatter_text(evidence, elsewhere)} "
        f"({evidence.run_count(elsewhere)} runs each)",
        holds_in_own=_is_steadiest(evidence, own),
        holds_elsewhere=_is_steadiest(evidence, elsewhere),
    )


def _scatter_text(evidence: WildHorseEvidence, setting: SearchSetting) -> str:
    return ", ".join(f"{a} {percent_text(evidence.scatter(setting, a))}" for a in SearchAlgorithm)


def _is_steadiest(evidence: WildHorseEvidence, setting: SearchSetting) -> bool:
    scatter = {a: evidence.scatter(setting, a) for a in SearchAlgorithm}
    return all(
        scatter[SearchAlgorithm.IWHO][k] == min(values[k] for values in scatter.values()) for k in range(len(HEADINGS))
    )
