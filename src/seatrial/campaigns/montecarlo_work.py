"""Monte Carlo campaigns: known truth, noise, identification; errors against the Cramer-Rao bound."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np

from seatrial.campaigns.plan import MonteCarloPlan
from seatrial.campaigns.work import Row, Work, fit_rows
from seatrial.core.equations import Model
from seatrial.core.values import InputError, Record, Ship, channel_hint, spelling_hint
from seatrial.data.folder.model_file import read_model_file
from seatrial.data.trial import EstimateSettings, Run, Trial
from seatrial.data.trial.model_table import build_trial_model, ship_of
from seatrial.estimation.identify import IntervalMethod, identify
from seatrial.estimation.information.covariance import from_information
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE
from seatrial.physics.simulate.steer import manoeuvre as steered


@dataclass(frozen=True, eq=False)
class Craft:
    """A ship with the model that is its truth, and the state and inputs that its runs start from by default."""

    ship: Ship
    model: Model
    approach: Mapping[str, float] = field(default_factory=dict)

    @property
    def truth(self) -> dict[str, float]:
        """Return free coefficient -> true value, SI."""
        return {p.name: p.value for p in self.model.parameters.free}


@dataclass(frozen=True, eq=False)
class NoisyRepeats:
    """Identifies runs of a known craft with new noise for each seed.

    Attributes:
        start: the model from which the search starts; runs: without noise.
        noise: channel -> standard deviation, SI; bound: coefficient -> Cramer-Rao bound, SI.
    """

    craft: Craft
    start: Model
    runs: tuple[Record, ...]
    noise: Mapping[str, float]
    bound: Mapping[str, float]
    estimate: EstimateSettings
    intervals: IntervalMethod

    def __call__(self, keys: Mapping[str, Any]) -> Sequence[Row]:
        """Return the rows of one seed; errors are those of `identify`."""
        seed: int = keys["seed"]
        streams = np.random.SeedSequence(seed).spawn(len(self.runs))
        noisy = [with_noise(run, self.noise, np.random.default_rng(stream))
                 for run, stream in zip(self.runs, streams, strict=True)]  # fmt: skip
        trial = Trial(self.craft.ship, tuple(map(Run, noisy)), self.start, estimate=self.estimate,
                      truth=self.craft.truth)  # fmt: skip
        return fit_rows(identify(trial, seed, intervals=self.intervals), self.bound)


def montecarlo_work(plan: MonteCarloPlan, folder: Path) -> Work:
    """Return the work of a Monte Carlo plan; paths count from `folder`.

    Raises:
        InputError: the truth is no model file or lacks a ship; an unknown model, coefficient, input or channel; a run
            that cannot be simulated.
    """
    craft = _craft(plan, folder)
    noise = {channel: amount.in_si for channel, amount in plan.noise.items()}
    runs = clean_runs(craft, plan)
    for channel in noise:
        if channel not in runs[0]:
            raise InputError(f"noise: unknown channel '{channel}'{channel_hint(channel, sorted(runs[0].channels))}")
    kept = [*noise, *craft.model.input_names]
    measured = tuple(replace(run, channels={s: c for s, c in run.channels.items() if s in kept}) for run in runs)
    bound = cramer_rao_bound(craft.model, measured, noise)
    repeats = NoisyRepeats(craft, _start(craft.model, plan), measured, noise, bound, plan.estimate, plan.intervals)
    shared = plan.model_dump(mode="json", warnings=False, exclude={"question", "seeds", "first_seed", "truth"})
    truth = {"values": {p.name: p.value for p in craft.model.parameters}, "equations": craft.model.equation_hash}
    seeds = range(plan.first_seed, plan.first_seed + plan.seeds)
    return Work({**shared, "truth": truth}, [{"seed": seed} for seed in seeds], repeats, question=plan.question)


def with_noise(record: Record, noise: Mapping[str, float], rng: np.random.Generator) -> Record:
    """Return the record with white Gaussian noise on its channels.

    noise: channel -> standard deviation, SI; drawn channel after channel in that order.
    """
    channels = dict(record.channels)
    for symbol, deviation in noise.items():
        values = record[symbol] + deviation * rng.standard_normal(len(record))
        channels[symbol] = record.channel(symbol).with_values(values)
    return replace(record, channels=channels).with_step("sensor noise added")


def clean_runs(craft: Craft, plan: MonteCarloPlan) -> tuple[Record, ...]:
    """Return the runs of a plan without noise, at the rate of its records.

    Raises:
        InputError: an input or speed that nothing states, a simulation that diverges.
    """
    model, slew_rate = craft.model, plan.rudder_rate or SOLAS_SLEW_RATE * math.sqrt(craft.ship.scale)
    inputs = {name: value for name, value in craft.approach.items() if name in model.input_names and name != "delta"}
    inputs |= {name: amount.in_si for name, amount in plan.inputs.items()}
    records = []
    for k, text in enumerate(plan.manoeuvres, start=1):
        fine = steered(model, programme(text), dt=plan.step, speed=plan.speed, inputs=inputs, slew_rate=slew_rate,
                       approach=plan.approach)  # fmt: skip
        records.append(fine.resampled(plan.rate).renamed(f"{k} {text}"))
    return tuple(records)


def cramer_rao_bound(model: Model, runs: Sequence[Record], noise: Mapping[str, float]) -> dict[str, float]:
    """Return the smallest standard deviation that an unbiased estimate of each free coefficient can have, SI.

    From the information at the truth with the true noise, initial states unknown (Rao 1945, Bull. Calcutta Math. Soc.
    37, 81). A run without noise is the truth.
    """
    outputs = tuple(name for name in noise if name in model.observables)
    deviations = np.array([noise[name] for name in outputs])
    problem = OutputError(model, cut_segments(model, list(runs), outputs, None), deviations, workers=1)
    normal = problem.normal(problem.start(), problem.measured_initial_states())
    errors = from_information(normal.without_local()[1]).standard_error
    return dict(zip(model.parameters.free_names, errors.tolist(), strict=True))


def _craft(plan: MonteCarloPlan, folder: Path) -> Craft:
    """The craft of the plan: of its model file, or of its tables [ship] and [model]."""
    if plan.truth is not None:
        file = read_model_file(folder / plan.truth)
        ship = file.ship if plan.ship is None else ship_of(plan.ship)
        if ship is None:
            raise InputError(f"truth: '{plan.truth}' names no ship; add [ship] with name and L to the plan")
        return Craft(ship, file.model, file.approach)
    assert plan.ship is not None and plan.model is not None  # as the plan's schema has it
    ship = ship_of(plan.ship)
    return Craft(ship, build_trial_model(plan.model, ship))


def _start(model: Model, plan: MonteCarloPlan) -> Model:
    """The model from which each search starts."""
    names = model.parameters.free_names
    if plan.start == "truth":
        return model
    if isinstance(plan.start, str):
        return model.with_values(dict.fromkeys(names, 0.0), source="start of the search")
    for name in plan.start:
        if name not in names:
            raise InputError(f"start: '{name}' is no free coefficient{spelling_hint(name, list(names))}")
    values = {name: amount.in_si for name, amount in plan.start.items()}
    return model.with_values(values, source="start of the search")
