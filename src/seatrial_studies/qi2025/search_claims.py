"""Claims of accuracy, each verdict by a rule on the numbers of the searches."""

import numpy as np

from seatrial.core.results import Claim, Verdict
from seatrial_studies.qi2025.evidence import WildHorseEvidence, percent_text
from seatrial_studies.qi2025.published import SearchAlgorithm, mean_recomputed_error, printed_mean_errors
from seatrial_studies.qi2025.reproduction import SearchSetting

ABOUT_ONE_PERCENT, FAR_BETTER_FACTOR, EXACT_ERROR, MISSED_ERROR = 1.5, 3.0, 1e-9, 1e-3


def claims(evidence: WildHorseEvidence) -> tuple[Claim, ...]:
    """What the paper says of PSO, WHO and IWHO."""
    return (
        one_percent_claim(evidence),
        iwho_against_who_claim(evidence),
        particle_swarm_claim(evidence),
        same_conditions_claim(evidence),
        global_optimum_claim(evidence),
    )


def one_percent_claim(evidence: WildHorseEvidence) -> Claim:
    """Confirmed where single runs stay within 1.5 %, also off centre; refuted where they do not."""
    narrow, wide = (
        evidence.single_run_errors(s, SearchAlgorithm.IWHO) for s in (SearchSetting.PAPER, SearchSetting.OFF_CENTRE)
    )
    tens = [100.0 * float(np.median(again)) for again in evidence.reproduction.ten_run_errors.values()]
    carried = evidence.single_run_errors(SearchSetting.MODEL_STATE, SearchAlgorithm.IWHO)
    return Claim(
        "IWHO identifies with errors of about 1 %",
        Verdict.CONFIRMED if max(*narrow, *wide) <= ABOUT_ONE_PERCENT else Verdict.REFUTED,
        f"the tables print the error of the mean of ten runs: {percent_text(printed_mean_errors())} at 90/135/180°, "
        f"{percent_text([mean_recomputed_error(h, SearchAlgorithm.IWHO) for h in evidence.output_error])} "
        "recomputed. Here, in a box of ±10 % "
        f"centred on the truth, it is "
        f"{percent_text(evidence.errors_of_mean(SearchSetting.PAPER, SearchAlgorithm.IWHO))} ({percent_text(tens)} the "
        f"median when the ten are repeated); a single run is "
        f"{percent_text(narrow)} off, {percent_text(carried)} if candidates step from the identified "
        "model's state instead of "
        f"the true one. In a box of ±50 % whose centre is not the truth it is {percent_text(wide)}. A random guess in "
        "the ±10 % box has 5 %",
    )


def iwho_against_who_claim(evidence: WildHorseEvidence) -> Claim:
    """Confirmed where IWHO is three times better also with the whole record off centre; refuted where WHO is better."""
    plain, improved = (
        evidence.errors_of_mean(SearchSetting.PAPER, a) for a in (SearchAlgorithm.WHO, SearchAlgorithm.IWHO)
    )
    who, iwho = (
        evidence.single_run_errors(SearchSetting.WHOLE_OFF_CENTRE, a)
        for a in (SearchAlgorithm.WHO, SearchAlgorithm.IWHO)
    )
    pairs = list(zip(who, iwho, strict=True))
    better = sum(w < i for w, i in pairs)
    if all(FAR_BETTER_FACTOR * i <= w for w, i in pairs):
        verdict = Verdict.CONFIRMED
    else:
        verdict = Verdict.REFUTED if better > len(pairs) / 2 else Verdict.UNKNOWABLE
    return Claim(
        "IWHO is far more accurate than WHO",
        verdict,
        f"with one sample an iteration and a box about the truth it is: error of the mean {percent_text(plain)} by "
        f"WHO, {percent_text(improved)} by IWHO. With the whole record (eq. 27) and a box off centre WHO is the "
        f"better one at {better} of {len(pairs)} headings: {percent_text(who)} against {percent_text(iwho)}",
    )


def particle_swarm_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where PSO is the best of the three with the whole record off centre; else undecidable."""
    whole = {a: evidence.single_run_errors(SearchSetting.WHOLE_OFF_CENTRE, a) for a in SearchAlgorithm}
    columns = zip(*whole.values(), strict=True)
    is_best = all(pso <= min(who, iwho) for pso, who, iwho in columns)
    return Claim(
        "PSO is far less accurate than the other two, some of its errors near 60 %",
        Verdict.REFUTED if is_best else Verdict.UNKNOWABLE,
        f"with the whole record, the box off centre, its mean error is "
        f"{percent_text(whole[SearchAlgorithm.PSO])}, WHO's "
        f"{percent_text(whole[SearchAlgorithm.WHO])}, IWHO's {percent_text(whole[SearchAlgorithm.IWHO])}. "
        "Its ω, c1, c2 are not "
        "printed; ours, assumed, are those of the constriction",
    )


def same_conditions_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where PSO's printed values lie outside the box that WHO's are clipped to."""
    beyond, total, largest = evidence.audit.beyond_box
    hit, of = evidence.audit.saturated_values
    return Claim(
        "The three were compared under the same conditions",
        Verdict.REFUTED if beyond and hit > of / 2 else Verdict.UNKNOWABLE,
        f"{hit} of WHO's {of} values at 90 and 135° are clipped at -10 %, while {beyond} of PSO's {total} lie "
        f"farther out than 10 %, by up to {largest:.0f} %: PSO searched, or was free to leave for, a wider box",
    )


def global_optimum_claim(evidence: WildHorseEvidence) -> Claim:
    """Refuted where the truth is met exactly if it is the middle of the box, and missed a quarter of the box aside."""
    zero, aside = evidence.centre_bias.truth_at_centre, evidence.centre_bias.truth_off_centre
    error_text = "; ".join(f"{a} {100 * zero[a]:.1e} % against {100 * aside[a]:.1f} %" for a in SearchAlgorithm)
    is_drawn = zero[SearchAlgorithm.IWHO] <= EXACT_ERROR and aside[SearchAlgorithm.IWHO] >= MISSED_ERROR
    found_anyway = max(zero[SearchAlgorithm.IWHO], aside[SearchAlgorithm.IWHO]) <= MISSED_ERROR
    return Claim(
        "IWHO gets out of local optima and finds the global one",
        Verdict.REFUTED if is_drawn else Verdict.CONFIRMED if found_anyway else Verdict.UNKNOWABLE,
        "it finds the middle of a box that is symmetric about zero. Unknowns written as x in [-1, 1], fitness and box "
        f"width as in the paper, mean error with the truth at x = 0 against the truth at ±0.5: {error_text}. Eqs. (19) "
        "and (23) multiply positions, which draws them to zero",
    )
