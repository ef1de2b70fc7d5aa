"""Do 95 % intervals of predicted measures hold 95 % of what is measured? Truth the fitted model does not know.

`python benchmarks/coverage.py --series 100` fits every series of `disturbed.py` from published coefficients with priors
of 10 % and predicts a zigzag and both 35 deg turns that were kept out.
"""

import argparse
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from disturbed import HELD_OUT, TRAINING, sail, ships
from measure import Line, machine

from seatrial.core.equations import Model
from seatrial.core.results import Prediction
from seatrial.core.values import Prior, Record
from seatrial.data.trial import Role, TrialRecord
from seatrial.estimation.estimate.fit import ship_length_seconds
from seatrial.estimation.estimate.settings import Intervals
from seatrial.estimation.identify import Settings, identified
from seatrial.estimation.information.discrepancy import kind_of
from seatrial.estimation.predict.forecast import forecast
from seatrial.numerics.workers import mapped

LIMITS = (0.92, 0.97)
NOT_PREDICTED = ("rudder_deg", "approach_speed")
PRIOR, ZERO = 0.1, float(np.radians(1.0))


@dataclass(frozen=True)
class Told:
    """One measure of one held-out run: measured, simulated and the interval's half width."""

    series: int
    run: str
    kind: str
    measured: float
    simulated: float
    half: float

    @property
    def is_inside(self) -> bool:
        """Whether the interval holds the measured value."""
        return abs(self.measured - self.simulated) <= self.half


def expected(model: Model) -> Model:
    """The published model with priors of 10 % on the hull, as a trial file would set them."""
    p = model.parameters
    return model.with_parameters(
        p.with_priors({q.name: Prior(q.value, PRIOR * max(abs(q.value), 0.02), q.source) for q in p.free})
    )


def judged(model: Model, train: Sequence[Record], held: Sequence[Record], number: int, kind: Intervals) -> list[Told]:
    """Fit one series and compare the intervals of its held-out runs with what they show."""
    length = model.parameters["L"].value
    settings = Settings(
        segment_seconds=10.0, corrections=(("delta", "zero", ZERO, "rad"),), workers=1, intervals=kind, seed=number
    )
    found = identified(model, train, [r.name for r in train], length, settings)
    records = [TrialRecord(r, Role.TRAIN, r.name) for r in train] + [
        TrialRecord(r, Role.VALIDATE, r.name) for r in held
    ]
    told = forecast(found, records, ship_length_seconds(train, length), length, number).predictions
    return [entry for p in told if p.role == "validation" for entry in _told(p, number)]


def _told(p: Prediction, number: int) -> list[Told]:
    return [
        Told(number, p.record, kind_of(name), m.measured, m.simulated, 0.5 * (m.upper - m.lower))
        for name, m in p.measures.items()
        if name not in NOT_PREDICTED and None not in (m.measured, m.simulated, m.lower, m.upper)
    ]  # type: ignore[operator]


def series(count: int, seed: int, kind: Intervals) -> list[Told]:
    """All series."""
    streams = np.random.SeedSequence(seed).spawn(2 + len(TRAINING) + len(HELD_OUT))
    model, values = ships(count, np.random.default_rng(streams[0]))
    runs = [
        sail(model, values, o, np.random.default_rng(s))
        for o, s in zip((*TRAINING, *HELD_OUT), streams[1:], strict=False)
    ]
    start, split = expected(model), len(TRAINING)

    def one(i: int) -> list[Told]:
        return judged(start, [r[i] for r in runs[:split]], [r[i] for r in runs[split:]], i, kind)

    return [entry for made in mapped(one, range(count)) for entry in made]


def lines(told: Sequence[Told]) -> list[Line]:
    """Coverage by kind and pooled."""
    made = []
    for label, mine in (
        *(
            (
                f"{'turns' if 'turn' in run else 'zigzag'}: {kind}",
                [t for t in told if t.kind == kind and ("turn" in t.run) == ("turn" in run)],
            )
            for run, kind in dict.fromkeys(("turn" if "turn" in t.run else "zigzag", t.kind) for t in told)
        ),
        ("pooled", list(told)),
    ):
        share = float(np.mean([t.is_inside for t in mine]))
        half = float(np.median([t.half / max(abs(t.measured), 1e-9) for t in mine]))
        low, high = LIMITS
        pooled = label == "pooled"
        target, holds = (f"{low:g} to {high:g}", low <= share <= high) if pooled else ("", None)
        made.append(Line(f"{label} ({len(mine)}; median half width {half:.1%})", share, "", target, holds))
    return made


def main(arguments: list[str]) -> int:
    """Print the table; 1 if the target is missed."""
    parser = argparse.ArgumentParser(description="coverage of the intervals of predicted manoeuvring measures")
    parser.add_argument("--series", type=int, default=100)
    parser.add_argument("--seed", type=int, default=11)
    parser.add_argument("--intervals", type=Intervals, default=Intervals.AUTO)
    given = parser.parse_args(arguments)
    print(machine())
    began = time.perf_counter()
    table = lines(series(given.series, given.seed, given.intervals))
    for line in table:
        print(f"  {line.what:<76} {line.value:>8.3f} {line.verdict}")
    print(f"{given.series} series, {(time.perf_counter() - began) / given.series:.2f} s each")
    return int(any(line.holds is False for line in table))


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
