"""Claims of the paper with their evidence, and checks of our own numbers."""

import numpy as np

from seatrial.core.results import Check, Claim, Verdict
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.evidence import FinGainEvidence
from seatrial_studies.yu2014.improved_gains import MS_LIMIT
from seatrial_studies.yu2014.published import DESIGN_ROW, DESIGN_ROW_AT_22_KN, GAIN_NAMES, STATEMENTS, TABLE_1
from seatrial_studies.yu2014.published_loop import PREAMPLIFIER_LABELS
from seatrial_studies.yu2014.searches import FinGainSearches

PRINTED, WASHOUT = Preamplifier.PRINTED, Preamplifier.WASHOUT
THREE_GAIN_LIMIT, FIVE_GAIN_LIMIT = 0.62, 0.70
ON_FRONT = 0.99
ELSEWHERE_LIMIT = 0.8
TIME_RATIO_LIMIT = 1e-3
# rms log errors up to which table 1 and its baseline count as fitted; our choice
FIT_ERROR, BASELINE_ERROR = 0.25, 0.30
REDUCTION_TOLERANCE = 2.0  # points of reduction


def claims(evidence: FinGainEvidence) -> tuple[Claim, ...]:
    """Return all claims in the order of the page."""
    return (
        _fin_rate_claim(evidence),
        _reduction_claim(evidence),
        _design_point_claim(evidence),
        _energy_claim(evidence),
        _loop_claim(evidence),
        _saturation_claim(evidence),
        _optimality_claim(evidence),
        _search_claim(evidence),
        _global_optimum_claim(evidence),
    )


def _claim(key: str, verdict: Verdict, evidence: str) -> Claim:
    said = STATEMENTS[key]
    return Claim(f"{said.text[0].upper()}{said.text[1:]} ({said.source})", verdict, evidence)


def _fin_rate_claim(evidence: FinGainEvidence) -> Claim:
    rows = evidence.audit.larger_rates
    return _claim(
        "rate",
        Verdict.CONFIRMED if rows == len(TABLE_1) else Verdict.REFUTED,
        f"by its own table in {rows} of {len(TABLE_1)} rows; at 22 / 90 {DESIGN_ROW_AT_22_KN.traditional.rate} against "
        f"{DESIGN_ROW_AT_22_KN.genetic.rate}°/s",
    )


def _reduction_claim(evidence: FinGainEvidence) -> Claim:
    rows = evidence.audit.lower_reductions
    return _claim(
        "reduction",
        Verdict.CONFIRMED if rows == len(TABLE_1) else Verdict.REFUTED,
        f"by its own table lower in {rows} of {len(TABLE_1)} rows, at 18 / 90; higher in the others",
    )


def _design_point_claim(evidence: FinGainEvidence) -> Claim:
    gap = DESIGN_ROW.traditional.reduction - DESIGN_ROW.genetic.reduction
    noise = (100.0 - DESIGN_ROW.genetic.reduction) * evidence.rms_variation * np.sqrt(2.0)
    return _claim(
        "set",
        Verdict.UNKNOWABLE,
        f"the drop is {gap:.2f} points; the rms roll of one record of 1000 s varies by "
        f"{100 * evidence.rms_variation:.1f} %, "
        f"so that between two such records reductions differ by {noise:.1f} points by chance. The PID's gains "
        "are not printed",
    )


def _energy_claim(evidence: FinGainEvidence) -> Claim:
    saved = [1.0 - (row.genetic.rate / row.traditional.rate) ** 2 for row in TABLE_1]
    return _claim(
        "energy",
        Verdict.UNKNOWABLE,
        "by its table W, the square of the fin rate, changes by "
        + ", ".join(f"{-100 * s:+.0f} %" for s in saved)
        + f"; but {len(evidence.audit.contradictory_rows)} of {len(TABLE_1)} rows contradict themselves "
        f"(roll without fins implied at 22 / 90: {DESIGN_ROW_AT_22_KN.traditional.uncontrolled:.2f}° and "
        f"{DESIGN_ROW_AT_22_KN.genetic.uncontrolled:.2f}°), "
        "and the gains compared with are not printed",
    )


def _loop_claim(evidence: FinGainEvidence) -> Claim:
    made = " and ".join(
        f"{evidence.table_1_responses[r][4].reduction:.1f} % ({PREAMPLIFIER_LABELS[r]})" for r in Preamplifier
    )
    return _claim(
        "loop",
        Verdict.REFUTED,
        "at 90° waves are met alike at any speed: with a constant K_alpha both rows would be one, but the table has "
        f"{DESIGN_ROW.genetic.reduction} and {DESIGN_ROW_AT_22_KN.genetic.reduction} %. With lift growing "
        "as the square of "
        f"the speed 22 / 90 becomes {made}",
    )


def _saturation_claim(evidence: FinGainEvidence) -> Claim:
    made = {r: evidence.audit.roll_responses[r] for r in Preamplifier}
    least = min(m.saturation_percent for m in made.values())
    return _claim(
        "saturation",
        Verdict.REFUTED if least > 20.0 else Verdict.UNKNOWABLE,
        "; ".join(
            f"{PREAMPLIFIER_LABELS[r]}: {m.fin:.1f}° rms, {m.saturation_percent:.0f} % of amplitudes above 22°"
            for r, m in made.items()
        )
        + ". In our long-crested sea, whose level is not the paper's; J2 pulls towards 20 % from both sides and "
        "bounds nothing",
    )


def _optimality_claim(evidence: FinGainEvidence) -> Claim:
    (printed, _), (_, washout) = evidence.three_gain_optima[PRINTED], evidence.three_gain_optima[WASHOUT]
    return _claim(
        "optimal",
        Verdict.UNKNOWABLE,
        f"it hangs on the preamplifier. As printed no: {_gain_text(printed.gains)} has all three objectives at most "
        f"{printed.objective_ratios.max():.3f} of the paper's at Ms {printed.Ms:.2f} instead of "
        f"{evidence.audit.roll_responses[PRINTED].Ms:.2f}. As a washout they lie on the front of three "
        "gains at their own Ms "
        f"(best worst share {washout.objective_ratios.max():.4f}), and five gains leave "
        f"{evidence.five_gain_design.design_seas[0].roll_ratio:.2f} of "
        "their roll variance at no more fin rate",
    )


def _search_claim(evidence: FinGainEvidence) -> Claim:
    found = [evidence.searches_with(r) for r in Preamplifier]
    refuted = any(s.relative_spread.max() > 0.5 or s.fragile_count for s in found)
    return _claim(
        "search",
        Verdict.REFUTED if refuted else Verdict.CONFIRMED,
        "; ".join(_scatter_text(s) for s in found),
    )


def _scatter_text(searches: FinGainSearches) -> str:
    spread = ", ".join(f"{100 * v:.0f}" for v in searches.relative_spread)
    return (
        f"{PREAMPLIFIER_LABELS[searches.setting.preamplifier]}: over {len(searches.Ms)} seeds the answers "
        f"spread over {spread} % of the ranges of "
        f"KP, KI, KD, Ms to {searches.Ms.max():.3g}, {searches.is_dominated.sum()} beaten in all "
        "objectives by what other seeds saw, the "
        f"nearest to the paper's answer off by {100 * searches.distance_to_published:.0f} % of a range"
    )


def _global_optimum_claim(evidence: FinGainEvidence) -> Claim:
    least = {r: min(values) for r, values in evidence.ratios_elsewhere.items()}
    following = evidence.table_1_responses[WASHOUT][0].reduction
    row = {r: TABLE_1[values.index(least[r])].name for r, values in evidence.ratios_elsewhere.items()}
    return _claim(
        "global",
        Verdict.REFUTED if max(least.values()) < ELSEWHERE_LIMIT else Verdict.UNKNOWABLE,
        "the search has one sea and one speed. Other gains in the paper's box leave of both roll and fin-rate variance "
        + " and ".join(f"{least[r]:.2f} at {row[r]} ({PREAMPLIFIER_LABELS[r]})" for r in Preamplifier)
        + f"; in long following waves (18 / 45) the paper's reduce the roll by {following:.0f} % as a washout",
    )


def _gain_text(values: np.ndarray) -> str:
    return ", ".join(f"{name} {value:.2f}" for name, value in zip(GAIN_NAMES, values, strict=True))


def checks(evidence: FinGainEvidence) -> tuple[Check, ...]:
    """Return the checks of our own numbers; each can fail."""
    made = evidence.five_gain_design
    held = made.held_out_seas[:2]
    at_22 = evidence.table_1_responses[WASHOUT][4].reduction - DESIGN_ROW_AT_22_KN.genetic.reduction
    printed, washout = evidence.three_gain_optima[PRINTED][0], evidence.three_gain_optima[WASHOUT][1]
    compiled, single = evidence.time_domain_seconds
    narrowest = float(evidence.searches_with(WASHOUT).relative_spread.min())
    worst, rate = max(c.roll_ratio for c in made.design_seas), max(c.rate_ratio for c in made.design_seas)
    return (
        _check_at_most(
            "as printed: largest objective of better gains over the paper's",
            float(printed.objective_ratios.max()),
            THREE_GAIN_LIMIT,
        ),
        _check_at_most("as printed: their Ms", printed.Ms, MS_LIMIT + 1e-6),
        Check(
            "washout: best worst objective of three gains over the paper's, at its Ms",
            float(washout.objective_ratios.max()),
            f"{ON_FRONT} to 1: the paper's lie on the front",
            bool(ON_FRONT <= washout.objective_ratios.max() <= 1.0 + 1e-9),
        ),
        _check_at_most(
            "washout, five gains: roll variance over the paper's, worse of two seas", worst, FIVE_GAIN_LIMIT
        ),
        _check_at_most("washout, five gains: fin-rate variance over the paper's, worse of two seas", rate, 1.0 + 1e-6),
        _check_at_most("washout, five gains: Ms", made.Ms, MS_LIMIT + 1e-6),
        _check_at_most("the same, JONSWAP: roll variance over the paper's", held[0].roll_ratio, FIVE_GAIN_LIMIT),
        _check_at_most("the same, JONSWAP: fin-rate variance over the paper's", held[0].rate_ratio, 1.0),
        _check_at_most(
            "the same, JONSWAP short-crested: roll variance over the paper's", held[1].roll_ratio, FIVE_GAIN_LIMIT
        ),
        _check_at_most("the same, JONSWAP short-crested: fin-rate variance over the paper's", held[1].rate_ratio, 1.0),
        Check(
            "washout, 22 / 90 with lift as U²: points of reduction from the paper's",
            at_22,
            f"±{REDUCTION_TOLERANCE:g}",
            abs(at_22) <= REDUCTION_TOLERANCE,
        ),
        _check_at_most("table 1 fitted, GA: rms log error, better reading", evidence.best_fit.log_error, FIT_ERROR),
        _check_at_most(
            "table 1 fitted, PID: rms log error, better reading",
            min(f.baseline_log_error for f in evidence.table_1_fits),
            BASELINE_ERROR,
        ),
        Check(
            "washout: narrowest spread of a gain over seeds, share of its range",
            narrowest,
            "above 0.2: no attractor",
            narrowest > 0.2,
        ),
        _check_at_most(
            "the search's time over scipy's lsim records", evidence.search_seconds / single, TIME_RATIO_LIMIT
        ),
        _check_at_most(
            "the search's time over compiled records",
            evidence.search_seconds / compiled,
            TIME_RATIO_LIMIT,
        ),
    )


def _check_at_most(name: str, value: float, limit: float) -> Check:
    return Check(name, float(value), limit, bool(value <= limit))
