"""What the page answers to its question, from the numbers of the verdicts."""

import numpy as np

from seatrial.core.text import significant
from seatrial_studies.controller_cost import largest_excess, uncontrolled_excess_text
from seatrial_studies.published_ship import HEADINGS
from seatrial_studies.qi2025.ablation import HerdVariant
from seatrial_studies.qi2025.evidence import WildHorseEvidence, percent_text, range_text, simulated_steps
from seatrial_studies.qi2025.published import SearchAlgorithm, mean_recomputed_error
from seatrial_studies.qi2025.reproduction import ABLATION_RUNS, RUNS, TEN_RUN_REPEATS, SearchSetting
from seatrial_studies.qi2025.search_claims import mating_text

_LONG_NAMES = {
    SearchAlgorithm.IWHO: "improved wild horse optimiser (IWHO)",
    SearchAlgorithm.WHO: "wild horse optimiser (WHO)",
    SearchAlgorithm.PSO: "particle swarm optimisation (PSO)",
}


def answer(evidence: WildHorseEvidence) -> tuple[str, ...]:
    """Return the sentences, the most important first; before them those of a quick version."""
    sentences = (_own_setting, _elsewhere, _print, _least_squares, _cost)
    return (*_quick_version(evidence), *(sentence(evidence) for sentence in sentences))


def _quick_version(evidence: WildHorseEvidence) -> tuple[str, ...]:
    """Return what a quick version has fewer of; nothing of the whole one."""
    if not evidence.reproduction.is_quick:
        return ()
    tens = len(next(iter(evidence.reproduction.ten_runs.values())).tens)
    return (
        "This is the quick version: at each heading "
        f"{evidence.run_count(SearchSetting.PAPER)} runs in the chosen setting and "
        f"{evidence.run_count(SearchSetting.OFF_CENTRE)} elsewhere (the whole version: {RUNS}; from the model's own "
        f"state {evidence.run_count(SearchSetting.MODEL_STATE)} in both), {evidence.ablation_runs} of the search with "
        "parts "
        f"left out ({ABLATION_RUNS}), the ten runs made {tens} times ({TEN_RUN_REPEATS}).",
    )


def _own_setting(evidence: WildHorseEvidence) -> str:
    errors = {a: range_text(evidence.single_run_errors(SearchSetting.PAPER, a)) for a in SearchAlgorithm}
    iwho, who, pso = (_LONG_NAMES[a] for a in reversed(SearchAlgorithm))
    return (
        f"Only in a box of ±10 % about the truth, with the true state before each sample known. There a run of the "
        f"{iwho} ends {errors[SearchAlgorithm.IWHO]} off, one of the {who} {errors[SearchAlgorithm.WHO]}, one of {pso} "
        f"{errors[SearchAlgorithm.PSO]}."
    )


def _elsewhere(evidence: WildHorseEvidence) -> str:
    carried, wide = (
        range_text(evidence.single_run_errors(s, SearchAlgorithm.IWHO))
        for s in (SearchSetting.MODEL_STATE, SearchSetting.OFF_CENTRE)
    )
    share = evidence.ablation.share_at_centre(SearchSetting.PAPER, None)
    complete, bare = (
        evidence.ablation.mean_errors(SearchSetting.WHOLE_OFF_CENTRE, v) for v in (None, HerdVariant.NO_ADDITION)
    )
    runs = evidence.run_count(SearchSetting.OFF_CENTRE)
    return (
        f"Elsewhere not: from the identified model's own state IWHO ends {carried} off, in a box of ±50 % off centre "
        f"{wide} ({evidence.run_count(SearchSetting.MODEL_STATE)} and {runs} runs at each heading); a random guess in "
        f"the narrow box is 5 % off. {100.0 * share:.0f} % of its values in that box are the truth to the last digits, "
        "because the truth is the middle: horses clipped at opposite ends have their foal there (eq. 18); "
        f"{mating_text(evidence)}. With the whole record and the truth off centre these {evidence.ablation_runs} runs "
        f"end {percent_text(complete)} off, without its three additions {percent_text(bare)}."
    )


def _print(evidence: WildHorseEvidence) -> str:
    """Return which setting each printed column is near."""
    printed = {a: percent_text([mean_recomputed_error(h, a) for h in HEADINGS]) for a in SearchAlgorithm}
    beyond, total, _ = evidence.audit.beyond_box
    means = {
        a: percent_text(evidence.errors_of_mean(SearchSetting.PAPER, a))
        for a in (SearchAlgorithm.IWHO, SearchAlgorithm.WHO)
    }
    hit, means_count = evidence.audit.saturated_values
    return (
        "The print fits no single setting. Mean errors at 90/135/180°, recomputed from its values: IWHO's "
        f"{printed[SearchAlgorithm.IWHO]} are nearest to ours in the chosen setting ({means[SearchAlgorithm.IWHO]}); "
        f"WHO's {printed[SearchAlgorithm.WHO]}, with {hit} of {means_count} values at 90 and 135° at the lower end of "
        f"±10 %, come from no setting tried; {beyond} of PSO's {total} values ({printed[SearchAlgorithm.PSO]}) lie "
        "outside the box that WHO's suggest."
    )


def _least_squares(evidence: WildHorseEvidence) -> str:
    fits = evidence.output_error.values()
    worst = max(float(np.max(np.abs(o.noise_free_errors))) for o in fits)
    noisy = [100.0 * float(np.mean(np.abs(o.noisy_errors))) for o in fits]
    judged, evaluations = evidence.evaluations(SearchAlgorithm.IWHO), evidence.output_error_evaluations
    return (
        "It need not be done so: least squares on the motions over the whole record finds all eight coefficients "
        f"within {significant(worst, 1)} of their values without noise, and {percent_text(noisy)} off with 1 cm and "
        f"0.02° of noise, {significant(evidence.bound_ratio, 2)} times the Cramér-Rao bound. It takes at most "
        f"{evaluations} evaluations of the whole record with its slopes, "
        f"{simulated_steps(evaluations, has_slopes=True)} simulated steps; a run of IWHO judges its "
        f"{judged} candidates by one step each, or, with the whole record, by "
        f"{simulated_steps(judged, has_slopes=False)} steps."
    )


def _cost(evidence: WildHorseEvidence) -> str:
    printed = largest_excess(evidence.controllers, lambda method: method.endswith("printed") and "b53" not in method)
    ours = largest_excess(evidence.controllers, lambda method: method.startswith("ours"))
    return (
        "For the fin controller tried here the differences are small: tuned on the printed coefficients of any of the "
        f"three it costs at most {significant(100.0 * printed, 1)} % more on the true ship than tuned on the truth, on "
        f"ours {significant(100.0 * ours, 1)} %; without control the cost is "
        f"{uncontrolled_excess_text(evidence.controllers)} "
        "more."
    )
