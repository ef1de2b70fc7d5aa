"""Tables of the chain as a user runs it: thirteen terms to the selected, steps left out, other speeds."""

from seatrial.core.results import Table
from seatrial_studies.song2025.cleaning_ablation import BAD_SHARE, SPIKE
from seatrial_studies.song2025.evidence import SupportVectorEvidence
from seatrial_studies.song2025.published import DROPPED_COEFFICIENTS
from seatrial_studies.song2025.reproduction import EstimatorResult


def chain_tables(evidence: SupportVectorEvidence) -> tuple[Table, ...]:
    """Return the chain, its steps left out, planted bad data, other speeds."""
    return _chain(evidence), _steps(evidence), _planted(evidence), _speeds(evidence)


def _chain(evidence: SupportVectorEvidence) -> Table:
    labels = ("original, noise-free", "improved, noise-free", "original, sensor noise", "improved, sensor noise")
    rows = []
    for label, result in zip(labels, evidence.reproduction.published, strict=True):
        zero = [n for n, v in zip(evidence.indirect_sensitivity.names, result.values, strict=True) if v == 0.0]
        dropped = [*zero, *(n for n in DROPPED_COEFFICIENTS if n not in result.candidates)]
        scores = " / ".join(f"{result.test[e].explained:.3g}" if e in result.test else "-" for e in "uvr")
        kept = ", ".join(f"{n} {v:.3g}" for n, v in result.candidates.items()) or "none"
        rows.append((label, ", ".join(dropped) or "none", kept, scores, 100.0 * result.median_error))
    return Table(
        "The chain: thirteen terms, Lasso, support vectors",
        ("pipeline", "Lasso takes out", "kept beyond the eleven", "test rows explained, u / v / r", "median error %"),
        tuple(rows),
        "One chain: thirteen candidates, what Lasso keeps of them, support vectors on those; simulated series. N_vrr "
        "and "
        "N_vvr are zero in truth. The last 20 % of the record are predicted row by row: a good score there says "
        "nothing of "
        "the coefficients",
    )


def _steps(evidence: SupportVectorEvidence) -> Table:
    return Table(
        "Conclusions 2 to 4: the improved pipeline with each step left out, noise-free simulated series",
        ("pipeline", "median error %", "largest %", "note"),
        tuple((r.name, 100.0 * r.median_error, 100.0 * r.largest_error, r.note) for r in evidence.ablation.steps),
        "Cleaning takes nothing but small values here: simulated data without noise are clean",
    )


def _planted(evidence: SupportVectorEvidence) -> Table:
    rows = [(p.kind, p.spoiled, *_errors(p.cleaned), *_errors(p.uncleaned)) for p in evidence.ablation.planted]
    return Table(
        "Conclusion 2: bad data planted in the simulated series",
        ("kind", "samples", "cleaned: median error %", "largest %", "not cleaned: median error %", "largest %"),
        tuple(rows),
        f"{100.0 * BAD_SHARE:g} % of the samples: outliers of {SPIKE:g} deviations in u, v and r; dropouts, at which "
        "the three "
        "read zero; duplicates that repeat the sample before in every channel",
    )


def _errors(result: EstimatorResult) -> tuple[float | str, float | str]:
    return (result.note, "") if result.note else (100.0 * result.median_error, 100.0 * result.largest_error)


def _speeds(evidence: SupportVectorEvidence) -> Table:
    names = list(evidence.speeds[0].errors)
    rows = [
        (s.factor, s.speed, *(100.0 * s.errors[n] for n in names), *(s.cc[n] for n in names)) for s in evidence.speeds
    ]
    return Table(
        "Conclusion 1: found at one speed, predicted at others, 20/20 zigzag",
        ("jet velocity", "approach m/s", *(f"error %, {n}" for n in names), *(f"least CC, {n}" for n in names)),
        tuple(rows),
        "Error: the largest RMSE of u, v, r over the channel's rms. Forces of the model go with the square of the "
        "speed, "
        "and so do those of the truth: the nozzle's rate alone differs from one speed to another. A real hull "
        "changes its "
        "attitude and wave pattern with speed; no simulation with this model can show that",
    )
