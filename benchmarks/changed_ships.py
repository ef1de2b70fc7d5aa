"""A ship that changes under way: how soon it is seen, against an oracle; false alarms, and intervals afterwards.

    python benchmarks/changed_ships.py [--seeds 20] [--hours 2] [--stretches 2]

A ship in head-quartering waves is simulated with forces and fin recorded, changes some coefficients at 200 s, at once
or along a ramp, and is fed to the follower as a stream would be. A change is seen where a snapshot names one.
Coverage is the share of 95 % intervals of coefficients that hold the changed ship's.

The oracle knows ship, instant, ramp and which coefficients change: the likelihood ratio of the model refitted in
these alone from the instant on, quadratic about their true values. Its threshold is that of the same test with
unknown instant at five alarms in 300 h: 14.0 nats for one coefficient, as improbable a value for several. Where it
finds less than 95 % in 300 s the change cannot be found, and is listed with its nats a second alone.

Hours without change are stretches of ten minutes, each in a sea of its own, 0.3 to 1.5 times as high as the others';
disturbed stretches have what a change may be mistaken for; of those without an alarm some are not watched to the end,
and say so. Manoeuvring models are not watched, so that none is here.
"""

import argparse
import sys
import time
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from itertools import pairwise

import numpy as np
from follow import NOISE, QI2025_SHIP, WAVES_AND_FIN, layout, samples
from measure import Line, at_least, at_most, machine
from numpy.typing import NDArray
from scipy import stats

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.data.check.conventions import canonical_record
from seatrial.data.trial import Trial
from seatrial.data.trial.settings import Stream, StreamSource
from seatrial.estimation.identify.online import OnlineEstimator
from seatrial.physics.simulate.linear import LinearBatch
from seatrial.physics.simulate.replay import inputs_of
from seatrial_studies.heave_pitch_search import with_physics_start
from seatrial_studies.seaway import SIGNIFICANT_HEIGHT, SeawayScenario, ship, simulate_seaway_run

Array = NDArray[np.float64]
HEADING, DT, CHANGED = 135, 0.1, 200.0
HOUR, STRETCH, SHORT_STRETCH = 3600.0, 600.0, 300.0
FINDABLE = 300.0  # s in which the oracle has to find a change that counts
AFTER = (10.0, 20.0, 40.0, 100.0)  # s behind the alarm, where intervals are counted
AFTER_RAMP = 60.0  # s behind the end of a ramp, from where they are
SHARE, WITHIN, LEAST = 0.95, 1.3, 0.3  # of voyages; times the oracle's time; s: limits of a follower's delay
ONE_COEFFICIENT = 14.0  # nats: threshold of a test that knows the coefficient but not the instant
COVERED = 0.92  # of the intervals behind an alarm, of all cells together
SAMPLE = ("a33 +20 %", "b33 +10 %", "b53 +20 %", "a33 +37 %, b33 -20 %", "five by 14 %", "b33 +20 % over 60 s",
          "a33 +20 %, then b33 +20 % 70 s later")  # fmt: skip  # cells of the short sample
MOST_ALARMS, OF_STRETCHES = 5.0 / 300.0, 1.0 / 20.0  # alarms an hour; alarms a disturbed stretch
RENEWED = (0.3, 1.5)  # heights of seas without change, times the others'
RAMP_PIECE, STEP = 1.0, 1e-3  # s in which coefficients stand still on a ramp; relative step of a difference


@dataclass(frozen=True)
class Change:
    """Factors of coefficients from an instant [s] on, reached along a ramp [s]."""

    factors: Mapping[str, float]
    instant: float = CHANGED
    ramp: float = 0.0

    def values(self, when: float) -> dict[str, float]:
        """Factors at a time [s]."""
        share = float(when >= self.instant) if self.ramp == 0.0 else np.clip((when - self.instant) / self.ramp, 0, 1)
        return {name: 1.0 + float(share) * (factor - 1.0) for name, factor in self.factors.items()}

    @property
    def begins(self) -> list[float]:
        """Where the coefficients take another value [s]."""
        return [self.instant, *np.arange(self.instant, self.instant + self.ramp + RAMP_PIECE / 2, RAMP_PIECE)[1:]]


@dataclass(frozen=True)
class Cell:
    """A change that is to be found, those before it, and the sea."""

    change: Change
    before: tuple[Change, ...] = ()
    height: float = SIGNIFICANT_HEIGHT

    @property
    def changes(self) -> tuple[Change, ...]:
        """All of them, in their order."""
        return (*self.before, self.change)


CELLS: Mapping[str, Cell] = {
    "a33 +10 %": Cell(Change({"a33": 1.1})),
    "a33 +20 %": Cell(Change({"a33": 1.2})),
    "b33 +10 %": Cell(Change({"b33": 1.1})),
    "b33 +40 %": Cell(Change({"b33": 1.4})),
    "a55 -20 %": Cell(Change({"a55": 0.8})),
    "b53 +10 %": Cell(Change({"b53": 1.1})),
    "b53 +20 %": Cell(Change({"b53": 1.2})),
    "a33 +37 %, b33 -20 %": Cell(Change({"a33": 1.37, "b33": 0.8})),
    "five by 14 %": Cell(Change({"a33": 1.14, "a55": 0.86, "b33": 1.14, "b55": 0.86, "b35": 1.14})),
    "b33 +20 % over 60 s": Cell(Change({"b33": 1.2}, ramp=60.0)),
    "a33 +20 %, then b33 +20 % 70 s later": Cell(Change({"b33": 1.2}, instant=CHANGED + 70.0), (Change({"a33": 1.2}),)),
    "0.88 m: b33 +20 %": Cell(Change({"b33": 1.2}), height=0.88),
    "0.88 m: b53 +10 %": Cell(Change({"b53": 1.1}), height=0.88),
}


def motion_of(model: Model, changes: tuple[Change, ...], inputs: Array, start: Array) -> Array:
    """Simulate a ship whose coefficients change: states (rows, nx)."""
    begins = sorted({0.0, *(b for c in changes for b in c.begins)})
    rows = [r for r in (round(b / DT) for b in begins) if r < len(inputs) - 1] + [len(inputs) - 1]
    states = np.empty((len(inputs), len(model.states)))
    states[0] = start
    for first, last in pairwise(rows):
        middle = 0.5 * (first + last) * DT
        factors = [(name, f) for c in changes for name, f in c.values(middle).items()]
        values = {name: model.parameters[name].value for name, _ in factors}
        for name, factor in factors:
            values[name] *= factor
        now = model.with_values(values)
        batch = LinearBatch(now, np.ascontiguousarray(inputs[first : last + 1]), np.array([0, last - first + 1]), DT,
                            now.states)  # fmt: skip
        given = states[first][None], now.parameters.values[None], np.empty((1, 0))
        states[first : last + 1] = batch.simulate(0, 1, *given)[0]
    return states


@dataclass(frozen=True, eq=False)
class Voyage:
    """A record with sensor noise, the ship at its end, and the oracle's evidence from the change on, nats by sample."""

    record: Record
    truth: Model
    evidence: Array = field(default_factory=lambda: np.empty(0))

    def oracle_delay(self, threshold: float) -> float:
        """Seconds until the oracle has found the change; infinite if never."""
        over = np.flatnonzero(self.evidence > threshold)
        return float(over[0]) * DT if len(over) else np.inf


def voyage(
    cell: Cell, seconds: float, seed: int, gate: Callable[[Array], Array] = np.ones_like, quieter: float = 1.0
) -> Voyage:
    """Return a voyage in a sea of that seed; `gate` by time [s] on the forces of the waves, `quieter` on the noise."""
    rng = np.random.default_rng([seed, 17])
    made = simulate_seaway_run(SeawayScenario(HEADING, cell.height, seconds), rng)
    forces = {n: made.record.channel(n).with_values(made.record[n] * gate(made.record.time)) for n in ("F3", "M5")}
    record = Record("voyage", made.record.time, {**made.record.channels, **forces})
    inputs = inputs_of(made.truth, canonical_record(record, 0.0))
    start = np.array([record[s][0] if s in record else 0.0 for s in made.truth.states])
    places = [made.truth.states.index(s) for s in NOISE]

    def motions(*changes: Change) -> Array:
        return motion_of(made.truth, changes, inputs, start)[:, places]

    clean, sd = motions(*cell.changes), np.array(list(NOISE.values()))
    noise = quieter * sd * rng.standard_normal(clean.shape)
    measured = {s: record.channel(s).with_values(clean[:, k] + noise[:, k]) for k, s in enumerate(NOISE)}
    noisy = Record(record.name, record.time, {**record.channels, **measured}, record.kind, record.provenance)
    values = {n: made.truth.parameters[n].value for c in cell.changes for n in c.factors}
    for change in cell.changes:
        for name, factor in change.factors.items():
            values[name] *= factor
    if not cell.change.factors:
        return Voyage(noisy, made.truth)
    first, whole = round(cell.change.instant / DT), cell.change.factors
    white = ((clean + noise - motions(*cell.before)) / sd)[first:], (noise / sd)[first:]
    slopes = []
    for name in whole:
        near = [motions(*cell.before, _moved(cell.change, name, step)) for step in (STEP, -STEP)]
        slopes.append(((near[0] - near[1]) / (2.0 * STEP * sd))[first:])
    return Voyage(noisy, made.truth.with_values(values), _likelihood_ratio(*white, np.stack(slopes, axis=2)))


def _moved(change: Change, name: str, step: float) -> Change:
    return Change({**change.factors, name: change.factors[name] + step}, change.instant, change.ramp)


def _likelihood_ratio(before: Array, truth: Array, slopes: Array) -> Array:
    """Nats by sample: residuals of the ship before, of the true one, (rows, ny), and slopes there, (rows, ny, k)."""
    score = np.cumsum(np.einsum("tyk,ty->tk", slopes, truth), axis=0)
    information = np.cumsum(np.einsum("tyk,tyl->tkl", slopes, slopes), axis=0)
    information += 1e-9 * np.eye(slopes.shape[2]) * (1e-300 + np.trace(information, axis1=1, axis2=2)[:, None, None])
    gained = np.einsum("tk,tk->t", score, np.linalg.solve(information, score[..., None])[..., 0])
    return 0.5 * (np.cumsum(np.sum(before**2 - truth**2, axis=1)) + gained)


def threshold(coefficients: int) -> float:
    """Nats over which the oracle has found a change of so many coefficients."""
    return 0.5 * float(stats.chi2.isf(stats.chi2.sf(2.0 * ONE_COEFFICIENT, 1), coefficients))


def follower() -> tuple[OnlineEstimator, Trial, Stream]:
    stream = Stream(source=StreamSource.STDIN, layout=layout(WAVES_AND_FIN), rate=1.0 / DT)
    trial = Trial(ship=QI2025_SHIP, runs=(), model=with_physics_start(ship(HEADING)), noise=dict(NOISE), stream=stream)
    return OnlineEstimator(trial), trial, stream


@dataclass(frozen=True)
class Outcome:
    """Seconds to the alarm, infinite where none came; alarms before and further ones; covered shares by s behind it."""

    delay: float
    false_alarms: int
    further: int
    covered: Mapping[float, float]


def followed(made: Voyage, cell: Cell) -> Outcome:
    """Return what a follower says of a voyage, until intervals have been counted for the last time."""
    estimator, trial, stream = follower()
    names = trial.model.parameters.free_names
    values = np.array([made.truth.parameters[n].value for n in names])
    latest, alarms, covered, change = None, [], dict[float, float](), cell.change
    for sample in samples(made.record, stream):
        snapshot = estimator.update(sample)
        if snapshot.change is not None and snapshot.change is not latest:
            latest = snapshot.change
            alarms.append(sample.time)
        behind = [a for a in alarms if a > change.instant]
        counted = {behind[0] + s: s for s in AFTER} if behind else {}
        if change.ramp > 0.0:
            counted = {change.instant + change.ramp + AFTER_RAMP: AFTER_RAMP}
        for when, seconds in counted.items():
            if seconds not in covered and sample.time >= when:
                covered[seconds] = float(np.mean(np.abs(snapshot.value - values) <= 1.96 * snapshot.standard_error))
        if change.factors and behind and len(covered) == len(counted):
            break
    late = [a for a in alarms if a > change.instant]
    early = len([a for a in alarms if a <= cell.changes[0].instant])
    return Outcome(late[0] - change.instant if late else np.inf, early, max(len(late) - 1, 0), covered)


def _in_share(delays: list[float]) -> float:
    return float(np.quantile(delays, SHARE, method="higher"))


def cell_lines(name: str, seeds: int, pooled: dict[str, list[float]]) -> Iterator[Line]:
    """Compare follower and oracle in one cell, and add the shares that its intervals cover to those of others."""
    cell = CELLS[name]
    voyages = [voyage(cell, cell.change.instant + FINDABLE, seed) for seed in range(seeds)]
    limit = threshold(len(cell.change.factors))
    oracle = _in_share([v.oracle_delay(limit) for v in voyages])
    nats = float(np.mean([v.evidence[-1] / FINDABLE for v in voyages]))
    if not np.isfinite(oracle):
        yield Line(f"{name}: cannot be found, the oracle's evidence", nats, "nats/s")
        return
    outcomes = [followed(v, cell) for v in voyages]
    delays = [o.delay for o in outcomes]
    yield Line(f"{name}: the oracle's time for 95 %", oracle, "s")
    asked = max(WITHIN * oracle, oracle + LEAST)
    yield at_most(f"{name}: reported in 95 % of the voyages", _in_share(delays), "s", asked)
    place = "the end of a ramp" if cell.change.ramp > 0.0 else "an alarm"
    shown = {s: [o.covered[s] for o in outcomes if s in o.covered] for s in (*AFTER, AFTER_RAMP)}
    for seconds, shares in shown.items():
        pooled.setdefault(f"{seconds:.0f} s behind {place}", []).extend(shares)
    covered = ", ".join(f"{np.mean(shares):.3f} at {s:.0f} s" for s, shares in shown.items() if shares)
    counts = sum(o.false_alarms for o in outcomes), sum(o.further for o in outcomes)
    print(
        f"{name}: {nats:.3g} nats/s, oracle {oracle:.1f} s; reported in {_in_share(delays):.1f} s, median "
        f"{np.median(delays):.1f} s; coverage {covered}; "
        f"alarms before {counts[0]}, further {counts[1]}",
        flush=True,
    )


UNCHANGED = Change({}, instant=0.0)


def alarms_of(made: Voyage) -> tuple[int, bool]:
    """Findings on a ship that stays as it is, but for those withdrawn, and whether it is watched to the end."""
    estimator, _, stream = follower()
    alarms, snapshot = dict[float, bool](), estimator.snapshot
    for sample in samples(made.record, stream):
        snapshot = estimator.update(sample)
        if snapshot.change is not None:
            alarms[snapshot.change.since] = snapshot.change.is_believed
    is_doubted = snapshot.change is not None and not snapshot.change.is_believed
    return sum(alarms.values()), not (snapshot.unwatched or is_doubted)


def false_alarms(hours: float) -> int:
    """Return how often a change is reported of ships that stay as they are, each stretch in a sea of its own."""
    count = 0
    for seed in range(round(hours * HOUR / STRETCH)):
        height = SIGNIFICANT_HEIGHT * np.random.default_rng([seed, 5]).uniform(*RENEWED)
        count += alarms_of(voyage(Cell(UNCHANGED, height=height), STRETCH, 1000 + seed))[0]
    return count


Disturbance = Callable[[Voyage, np.random.Generator], Voyage]


def _measured(change: Callable[[Array, float, np.random.Generator], Array]) -> Disturbance:
    """A disturbance of each motion, given its sensor's standard deviation."""

    def disturb(made: Voyage, rng: np.random.Generator) -> Voyage:
        own = made.record.channels
        changed = {s: own[s].with_values(change(own[s].values, sd, rng)) for s, sd in NOISE.items()}
        return Voyage(Record("voyage", made.record.time, {**own, **changed}), made.truth)

    return disturb


def _more_noise(times: float) -> Disturbance:
    """Noise of so many times the sensors' on the whole, added to what is there."""
    return _measured(lambda v, sd, rng: v + sd * np.sqrt(times**2 - 1.0) * rng.standard_normal(len(v)))


def _spikes(values: Array, sd: float, rng: np.random.Generator) -> Array:
    return values + 20.0 * sd * (rng.random(len(values)) < 0.01) * rng.choice([-1.0, 1.0], len(values))


def _gap(seconds: float) -> Disturbance:
    """Without motions for so long, after 150 s."""
    rows = slice(round(0.5 * SHORT_STRETCH / DT), round((0.5 * SHORT_STRETCH + seconds) / DT))

    def empty(values: Array, *_: object) -> Array:
        without = values.copy()
        without[rows] = np.nan
        return without

    return _measured(empty)


def _coloured(memory: float) -> Disturbance:
    """Noise of the sensors' size with a memory of AR(1), beside their own."""

    def colour(values: Array, sd: float, rng: np.random.Generator) -> Array:
        noise = rng.standard_normal(len(values)) * np.sqrt(1.0 - memory**2)
        for row in range(1, len(noise)):
            noise[row] += memory * noise[row - 1]
        return values + sd * noise

    return _measured(colour)


def _force(factor: float) -> Disturbance:
    """The moment of the waves is recorded with a gain."""

    def scale(made: Voyage, _: object) -> Voyage:
        own = made.record.channels
        moment = own["M5"].with_values(factor * own["M5"].values)
        return Voyage(Record("voyage", made.record.time, {**own, "M5": moment}), made.truth)

    return scale


DISTURBANCES: Mapping[str, Disturbance] = {
    "noise x 0.5": lambda made, _: made,
    "noise x 1.3": _more_noise(1.3),
    "noise x 2": _more_noise(2.0),
    "noise x 5": _more_noise(5.0),
    "1 % spikes of 20 sd": _measured(_spikes),
    "a gap of 5 s": _gap(5.0),
    "a gap of 30 s": _gap(30.0),
    "AR(1) noise of 0.5 beside white": _coloured(0.5),
    "AR(1) noise of 0.9 beside white": _coloured(0.9),
    "waves that stop": lambda made, _: made,
    "moment 1 % high": _force(1.01),
    "moment 5 % high": _force(1.05),
}


def disturbed(stretches: int, seconds: float) -> Iterator[Line]:
    """Alarms of ships that stay as they are while something else happens."""
    for name, disturb in DISTURBANCES.items():
        count, watched = 0, 0
        for seed in range(stretches):
            gate = (
                (lambda t: np.where(t < 0.5 * SHORT_STRETCH, 1.0, 0.0)) if name == "waves that stop" else np.ones_like
            )
            quieter = 0.5 if name == "noise x 0.5" else 1.0
            made = voyage(Cell(UNCHANGED), seconds, 3000 + seed, gate, quieter)
            made = disturb(made, np.random.default_rng([seed, 7]))
            alarms, is_watched = alarms_of(made)
            count, watched = count + alarms, watched + is_watched
        print(
            f"{name}: {count} alarms in {stretches} stretches of {seconds:.0f} s, {watched} watched to the end",
            flush=True,
        )
        most = max(1.0, OF_STRETCHES * stretches)
        yield at_most(f"{name}: alarms in {stretches} stretches of {seconds:.0f} s", count, "", most)


def judged(names: Iterable[str], seeds: int, hours: float, stretches: int, seconds: float) -> Iterator[Line]:
    pooled: dict[str, list[float]] = {}
    for name in names:
        yield from cell_lines(name, seeds, pooled)
    for where, shares in pooled.items():
        if shares:
            yield at_least(f"coverage {where}, all together", float(np.mean(shares)), "1", COVERED)
    count = false_alarms(hours)
    print(f"{count} alarms in {hours:g} h without change", flush=True)
    yield at_most(f"alarms in {hours:g} h without change", count, "", max(1.0, MOST_ALARMS * hours))
    yield from disturbed(stretches, seconds)


def run() -> list[Line]:
    """Return a short sample."""
    return list(judged(SAMPLE, 4, 0.5, 1, SHORT_STRETCH))


def main(arguments: list[str]) -> int:
    """Print a line for each change; 1 where a limit is missed."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--seeds", type=int, default=20)
    parser.add_argument("--hours", type=float, default=2.0)
    parser.add_argument("--stretches", type=int, default=2)
    chosen, began, has_missed = parser.parse_args(arguments), time.process_time(), False
    print(machine())
    for line in judged(CELLS, chosen.seeds, chosen.hours, chosen.stretches, STRETCH):
        print(f"  {line.quantity:<78} {line.value:>10.4g} {line.unit:<8} {line.verdict}", flush=True)
        has_missed |= line.holds is False
    print(f"{time.process_time() - began:.0f} s of processor time")
    return int(has_missed)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
