"""Claims of the paper with their evidence, and checks of our own numbers."""

import numpy as np

from seatrial.core.results import Check, Claim, Verdict
from seatrial.physics.loops.fin import Preamplifier
from seatrial_studies.yu2014.better import CAP
from seatrial_studies.yu2014.evidence import Evidence
from seatrial_studies.yu2014.published import GAINS, SAME_AT_22, SET_AT, STATEMENTS, TABLE_1
from seatrial_studies.yu2014.readings import WORDS
from seatrial_studies.yu2014.searches import Searches

PRINTED, WASHOUT = Preamplifier.PRINTED, Preamplifier.WASHOUT
BEATEN, RICHER = 0.62, 0.70
ON_FRONT = 0.99
ELSEWHERE = 0.8
FASTER = 1e-3
FIT_ERROR, BASELINE_ERROR = 0.25, 0.30
AT_22 = 2.0  # points of reduction


def claims(seen: Evidence) -> tuple[Claim, ...]:
    """In the order of the page."""
    return (
        _rate(seen), _reduction(seen), _set(seen), _energy(seen), _loop(seen), _saturation(seen), _optimal(seen),
        _search(seen), _global(seen),
    )  # fmt: skip


def _claim(key: str, verdict: Verdict, evidence: str) -> Claim:
    said = STATEMENTS[key]
    return Claim(f"{said.words[0].upper()}{said.words[1:]} ({said.place})", verdict, evidence)


def _rate(seen: Evidence) -> Claim:
    rows = seen.audited.larger_rates
    return _claim(
        "rate",
        Verdict.CONFIRMED if rows == len(TABLE_1) else Verdict.REFUTED,
        f"by its own table in {rows} of {len(TABLE_1)} rows; at 22 / 90 {SAME_AT_22.traditional.rate} against "
        f"{SAME_AT_22.genetic.rate}°/s",
    )


def _reduction(seen: Evidence) -> Claim:
    rows = seen.audited.lower_reductions
    return _claim(
        "reduction",
        Verdict.CONFIRMED if rows == len(TABLE_1) else Verdict.REFUTED,
        f"by its own table lower in {rows} of {len(TABLE_1)} rows, at 18 / 90; higher in the others",
    )


def _set(seen: Evidence) -> Claim:
    gap = SET_AT.traditional.reduction - SET_AT.genetic.reduction
    noise = (100.0 - SET_AT.genetic.reduction) * seen.variation * np.sqrt(2.0)
    return _claim(
        "set",
        Verdict.UNKNOWABLE,
        f"the drop is {gap:.2f} points; the rms roll of one record of 1000 s varies by {100 * seen.variation:.1f} %, "
        f"so that between two such records reductions differ by {noise:.1f} points by chance. The PID's gains "
        "are not printed",
    )


def _energy(seen: Evidence) -> Claim:
    saved = [1.0 - (row.genetic.rate / row.traditional.rate) ** 2 for row in TABLE_1]
    return _claim(
        "energy",
        Verdict.UNKNOWABLE,
        "by its table W, the square of the fin rate, changes by " + ", ".join(f"{-100 * s:+.0f} %" for s in saved) +
        f"; but {len(seen.audited.contradicting)} of {len(TABLE_1)} rows contradict themselves (roll without fins "
        f"implied at 22 / 90: {SAME_AT_22.traditional.uncontrolled:.2f}° and {SAME_AT_22.genetic.uncontrolled:.2f}°), "
        "and the gains compared with are not printed",
    )  # fmt: skip


def _loop(seen: Evidence) -> Claim:
    made = " and ".join(f"{seen.table_1[r][4].reduction:.1f} % ({WORDS[r]})" for r in Preamplifier)
    return _claim(
        "loop",
        Verdict.REFUTED,
        "at 90° waves are met alike at any speed: with a constant K_alpha both rows would be one, but the table has "
        f"{SET_AT.genetic.reduction} and {SAME_AT_22.genetic.reduction} %. With lift growing as the square of "
        f"the speed 22 / 90 becomes {made}",
    )


def _saturation(seen: Evidence) -> Claim:
    made = {r: seen.audited.motions[r] for r in Preamplifier}
    least = min(m.saturated for m in made.values())
    return _claim(
        "saturation",
        Verdict.REFUTED if least > 20.0 else Verdict.UNKNOWABLE,
        "; ".join(f"{WORDS[r]}: {m.fin:.1f}° rms, {m.saturated:.0f} % of amplitudes above 22°" for r, m in made.items())
        + ". In our long-crested sea, whose level is not the paper's; J2 pulls towards 20 % from both sides and "
        "bounds nothing",
    )


def _optimal(seen: Evidence) -> Claim:
    (printed, _), (_, washout) = seen.three[PRINTED], seen.three[WASHOUT]
    return _claim(
        "optimal",
        Verdict.UNKNOWABLE,
        f"it hangs on the preamplifier. As printed no: {_gains(printed.gains)} has all three objectives at most "
        f"{printed.shares.max():.3f} of the paper's at Ms {printed.peak:.2f} instead of "
        f"{seen.audited.motions[PRINTED].peak:.2f}. As a washout they lie on the front of three gains at their own Ms "
        f"(best worst share {washout.shares.max():.4f}), and five gains leave {seen.richer.designed[0].roll:.2f} of "
        "their roll variance at no more fin rate",
    )


def _search(seen: Evidence) -> Claim:
    found = [seen.of(r) for r in Preamplifier]
    refuted = any(s.spread.max() > 0.5 or s.fragile for s in found)
    return _claim(
        "search",
        Verdict.REFUTED if refuted else Verdict.CONFIRMED,
        "; ".join(_scatter(s) for s in found),
    )


def _scatter(s: Searches) -> str:
    spread = ", ".join(f"{100 * v:.0f}" for v in s.spread)
    return (
        f"{WORDS[s.setting.reading]}: over {len(s.peak)} seeds the answers spread over {spread} % of the ranges of "
        f"KP, KI, KD, Ms to {s.peak.max():.3g}, {s.beaten.sum()} beaten in all objectives by what other seeds saw, the "
        f"nearest to the paper's answer off by {100 * s.nearest:.0f} % of a range"
    )


def _global(seen: Evidence) -> Claim:
    least = {r: min(values) for r, values in seen.elsewhere.items()}
    following = seen.table_1[WASHOUT][0].reduction
    row = {r: TABLE_1[values.index(least[r])].name for r, values in seen.elsewhere.items()}
    return _claim(
        "global",
        Verdict.REFUTED if max(least.values()) < ELSEWHERE else Verdict.UNKNOWABLE,
        "the search has one sea and one speed. Other gains in the paper's box leave of both roll and fin-rate variance "
        + " and ".join(f"{least[r]:.2f} at {row[r]} ({WORDS[r]})" for r in Preamplifier)
        + f"; in long following waves (18 / 45) the paper's reduce the roll by {following:.0f} % as a washout",
    )


def _gains(values: np.ndarray) -> str:
    return ", ".join(f"{name} {value:.2f}" for name, value in zip(GAINS, values, strict=True))


def checks(seen: Evidence) -> tuple[Check, ...]:
    """Ours; each can fail."""
    made = seen.richer
    held = made.held_out[:2]
    at_22 = seen.table_1[WASHOUT][4].reduction - SAME_AT_22.genetic.reduction
    printed, washout = seen.three[PRINTED][0], seen.three[WASHOUT][1]
    compiled, single = seen.in_time
    narrowest = float(seen.of(WASHOUT).spread.min())
    worst, rate = max(c.roll for c in made.designed), max(c.rate for c in made.designed)
    return (
        _at_most("as printed: largest objective of better gains over the paper's", float(printed.shares.max()), BEATEN),
        _at_most("as printed: their Ms", printed.peak, CAP + 1e-6),
        Check("washout: best worst objective of three gains over the paper's, at its Ms", float(washout.shares.max()),
              f"{ON_FRONT} to 1: the paper's lie on the front", bool(ON_FRONT <= washout.shares.max() <= 1.0 + 1e-9)),
        _at_most("washout, five gains: roll variance over the paper's, worse of two seas", worst, RICHER),
        _at_most("washout, five gains: fin-rate variance over the paper's, worse of two seas", rate, 1.0 + 1e-6),
        _at_most("washout, five gains: Ms", made.peak, CAP + 1e-6),
        _at_most("the same, JONSWAP: roll variance over the paper's", held[0].roll, RICHER),
        _at_most("the same, JONSWAP: fin-rate variance over the paper's", held[0].rate, 1.0),
        _at_most("the same, JONSWAP short-crested: roll variance over the paper's", held[1].roll, RICHER),
        _at_most("the same, JONSWAP short-crested: fin-rate variance over the paper's", held[1].rate, 1.0),
        Check("washout, 22 / 90 with lift as U²: points of reduction from the paper's", at_22, f"±{AT_22:g}",
              abs(at_22) <= AT_22),
        _at_most("table 1 fitted, GA: rms log error, better reading", seen.best_fit.error, FIT_ERROR),
        _at_most("table 1 fitted, PID: rms log error, better reading",
                 min(f.baseline_error for f in seen.fitted), BASELINE_ERROR),
        Check("washout: narrowest spread of a gain over seeds, share of its range",
              narrowest, "above .2: no attractor", narrowest > 0.2),
        _at_most("the search's time over scipy's lsim records", seen.seconds / single, FASTER),
        _at_most("the search's time over compiled records in vector lanes", seen.seconds / compiled, FASTER),
    )  # fmt: skip


def _at_most(name: str, value: float, limit: float) -> Check:
    return Check(name, float(value), limit, bool(value <= limit))
