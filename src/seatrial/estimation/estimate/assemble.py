"""Runs and settings put together as an output-error problem: records, timing of inputs, priors."""

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import Self

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, Array, ForcePoints, Index, InputError, Parameters, Prior, Record
from seatrial.core.values.arrays import Travel, travel
from seatrial.data.trial import EstimateSettings, Feedback, Role, Trial, TrialRecord
from seatrial.data.trial.craft_tables import refuse_unusable_feedback
from seatrial.data.trial.priors import JointPrior
from seatrial.estimation.information.covariance import inverse
from seatrial.estimation.problem.output_error import Contribution, DataTerm, Nuisance, OutputError
from seatrial.estimation.problem.segments import compared_outputs, cut_segments
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.physics.simulate.batch import InputCorrection

# The runs that one estimate is made from, and what else is measured of the ship.


@dataclass(frozen=True, eq=False)
class Runs:
    """Runs of one ship, all at one sampling rate, and what else is measured of it.

    Attributes:
        records: one for each run, in the notation table's frames, signs and units.
        sessions: of each record, the name of the group with which it shares offsets.
        length: of the ship [m].
        noise: channel -> known standard deviation, SI; that of other channels is estimated.
        forces: tables of static force points that are fitted with the runs.
        feedback: the controller that was on in some of them; None: none is declared.
        carried: information from records that are no longer kept.
        joint_priors: what earlier results say of several coefficients together.
    """

    records: tuple[Record, ...]
    sessions: tuple[str, ...]
    length: float
    noise: Mapping[str, float] = field(default_factory=dict)
    forces: tuple[ForcePoints, ...] = ()
    feedback: Feedback | None = None
    carried: tuple[DataTerm, ...] = ()
    joint_priors: tuple[JointPrior, ...] = ()

    @classmethod
    def one_session_each(cls, records: Sequence[Record], length: float) -> "Runs":
        """Return the runs as sessions of their own, named as the records; length: of the ship [m]."""
        return cls(tuple(records), tuple(record.name for record in records), length)

    def selected(self, indices: Sequence[int]) -> "Runs":
        """Return the runs at these positions; everything else stays."""
        records, sessions = (tuple(column[i] for i in indices) for column in (self.records, self.sessions))
        return replace(self, records=records, sessions=sessions)

    def __len__(self) -> int:
        return len(self.records)


def training_runs(trial: Trial, records: Sequence[TrialRecord]) -> Runs:
    """Return the training runs among the records, with the trial's known noise, force points and controller.

    Raises:
        InputError: the records do not hold what is declared of the controller.
    """
    train = [r for r in records if r.role is Role.TRAIN]
    if trial.feedback is not None:
        refuse_unusable_feedback(trial.feedback, [r.record for r in train], f"{trial.path}: " if trial.path else "")
    sessions = tuple(r.session for r in train)
    return Runs(
        tuple(r.record for r in train), sessions, trial.ship.length, trial.noise, trial.forces, trial.feedback,
        joint_priors=trial.joint_priors,
    )  # fmt: skip


# When inputs took effect: whether they are held between samples, and a delay that no record states.

_NOT_SET = ("wind_speed", "wind_direction", "alpha_w", "u", "omega_e")
"""Inputs that nobody aboard sets: wind, slope of waves, speed and frequency of encounter of a run."""

_FORCE_UNITS = ("N", "N m")
"""Units of inputs that are forces of waves."""

_OWN_RATE = 1.001
"""Ratio of the time step of a record to that of an input's source up to which they are one; chosen."""

UNIFORM = math.sqrt(12.0)
"""Length of a uniform distribution over its standard deviation."""

SOURCE = "uniform over the sample interval of its source"


def set_inputs(model: Model) -> tuple[str, ...]:
    """Return the inputs that somebody or something aboard sets, without those that a linear model holds by itself."""
    return tuple(
        i.name
        for i in model.equations.inputs
        if not i.is_held and i.name not in _NOT_SET and not (i.name in NOTATION and _is_force(NOTATION[i.name].unit))
    )


def _is_force(unit: str) -> bool:
    return unit in _FORCE_UNITS


def with_held_inputs(model: Model, records: Sequence[Record]) -> Model:
    """Return the model with those inputs constant from sample to sample that the records hold.

    A channel that says how it runs between samples is believed, and so is a command; others are judged by the share of
    their travel that lies within single samples, unless they were resampled: a step may then lie anywhere in a sample.
    """
    return model.with_held(name for name in set_inputs(model) if _is_held(name, records))


def _is_held(name: str, records: Sequence[Record]) -> bool:
    return sum((_judged_travel(record, name) for record in records if name in record), Travel()).is_stepped


def _judged_travel(record: Record, name: str) -> Travel:
    """Return the travel of a channel, all or nothing of it in steps where that is declared or cannot be judged."""
    channel = record.channel(name)
    seen = travel(channel.values)
    if channel.between or channel.is_command:
        return Travel(seen.total, seen.total if channel.is_held else 0.0)
    return Travel(seen.total, 0.0) if _is_resampled(record, name) else seen


def _is_resampled(record: Record, name: str) -> bool:
    source = record.channel(name).sample_s
    return 0.0 < source * _OWN_RATE < record.dt


def is_course_open(name: str, records: Sequence[Record]) -> bool:
    """Return whether no record says how an input runs between samples, as of a command, or was resampled."""
    present = [(r, r.channel(name)) for r in records if name in r]
    return not any(c.between or c.is_command or _is_resampled(r, name) for r, c in present)


def timing_nuisances(model: Model, records: Sequence[Record], settings: EstimateSettings) -> tuple[Nuisance, ...]:
    """Return a delay for each set input that moves in the records and that the settings do not name.

    Inputs that are the same in all records have none: a time between them would separate what no record does.
    """
    names = set_inputs(model)
    return tuple(
        Nuisance(
            InputCorrection(name, "delay"), Prior(0.0, _sample_interval(name, records) / UNIFORM, SOURCE), "s",
            is_spread_fixed=True,
        )
        for name in names
        if name not in settings.delays
        and any(name in r and np.ptp(r[name]) > 0.0 for r in records)
        and not any(_are_same(name, other, records) for other in names if other != name)
    )  # fmt: skip


def _are_same(name: str, other: str, records: Sequence[Record]) -> bool:
    return all(name in r and other in r and np.array_equal(r[name], r[other], equal_nan=True) for r in records)


def _sample_interval(name: str, records: Sequence[Record]) -> float:
    """Return the longest time between two samples of an input's source, s."""
    return max(r.channel(name).sample_s or r.dt for r in records if name in r)


# Information of discarded records on the coefficients, as a Gaussian prior at the point of linearisation.


@dataclass(frozen=True, eq=False)
class MarginalPrior:
    """Gauss-Newton's model of all discarded data, an `Addend`: gradient' d + 1/2 d' information d, d = theta - point.

    Attributes:
        indices: positions of the coefficients among all model parameters, (k,); point: (k,); information: (k, k).
        gradient: (k,), of the data at the point, where the gradient of the priors is its opposite.
    """

    indices: Index
    point: Array
    information: Array
    gradient: Array

    def cost(self, values: Array) -> float:
        """As `Addend.cost`."""
        off = values[self.indices] - self.point
        return float(self.gradient @ off + 0.5 * off @ self.information @ off)

    def normal(self, values: Array, free: Sequence[int]) -> Contribution:
        """As `Addend.normal`."""
        off = values[self.indices] - self.point
        own = [list(self.indices).index(i) if i in self.indices else -1 for i in free]
        known = np.array([i >= 0 for i in own])
        gradient, hessian = np.zeros(len(own)), np.zeros((len(own), len(own)))
        rows = np.array([i for i in own if i >= 0], dtype=np.int64)
        gradient[known] = (self.gradient + self.information @ off)[rows]
        hessian[np.ix_(known, known)] = self.information[np.ix_(rows, rows)]
        return Contribution(self.cost(values), gradient, hessian)

    def discounted(self, share: float) -> Self:
        """Return the prior with that share of its information: older data count less (exponential forgetting)."""
        return replace(self, information=share * self.information, gradient=share * self.gradient)

    def inflation(self, hessian: Array, covariance: Array) -> float:
        """Return how many times the coefficients' covariance (k, k) exceeds that of white residuals, one at least.

        hessian: as for `marginalise`. Well determined directions weigh most.
        """
        k = len(self.point)
        white = float(np.trace(self.information @ inverse(hessian)[:k, :k]))
        held = float(np.trace(self.information @ covariance))
        return max(held / white, 1.0) if white > 0.0 and np.isfinite(held) else 1.0


def marginalise(indices: Index, point: Array, hessian: Array, mean: Array, weight: Array) -> MarginalPrior:
    """Return the information of the data at the optimum `point` (k,) of data and priors together.

    hessian: of coefficients, then nuisances if any, (n, n), priors included; the nuisances are eliminated.
    mean, weight: of the coefficients' priors, (k,); these stay with the problem and are taken out.
    """
    k = len(point)
    own, tie, rest = hessian[:k, :k], hessian[:k, k:], hessian[k:, k:]
    known = own - tie @ inverse(rest) @ tie.T if len(rest) else own
    return MarginalPrior(indices, point, known - np.diag(weight), -weight * (point - mean))


# What an earlier result says of several coefficients together, as a term of the cost.


def joint_prior_term(parameters: Parameters, prior: JointPrior) -> MarginalPrior:
    """Return what the correlations add to the priors of each coefficient.

    1/2 d' (C^-1 - diag(C)^-1) d of the distance d from the mean: a Gaussian's exponent less those of its marginals.
    Together with the priors of each, which stay with the parameters, this is the Gaussian of covariance C.
    """
    indices = np.array([parameters.index(name) for name in prior.names], dtype=np.int64)
    added = inverse(prior.covariance) - np.diag(1.0 / np.diag(prior.covariance))
    return MarginalPrior(indices, prior.mean, added, np.zeros(len(indices)))


# Runs and settings put together as an output-error problem.

_ZERO_DEVIATIONS = {"rad": float(np.radians(2.0)), "m/s": 0.1, "rps": 0.1}
"""Prior standard deviation of a sensor's zero, SI, by unit: 2 deg, 0.1 m/s, 0.1 rps; chosen."""

_OTHER_ZERO_DEVIATION = 0.1
"""The same for channels of any other unit, SI; chosen."""

_GAIN_DEVIATION = 0.1
"""Prior standard deviation of a sensor's gain about 1; chosen."""

_DELAY_DEVIATION = 0.2
"""Prior standard deviation of an input's delay [s]; chosen."""

_NOISE_SHARE, _LEAST_NOISE = 0.1, 1e-9
"""Noise of a channel before any search: this share of its spread, at least this much, SI; chosen."""

_SOURCE = "house default"


def _zero_deviation(name: str, deviation: float | None) -> tuple[str, float]:
    """Return the unit of a channel, and the standard deviation of its zero, SI: as given, or by the unit."""
    unit = NOTATION[name].unit if name in NOTATION else "1"
    return unit, deviation or _ZERO_DEVIATIONS.get(unit, _OTHER_ZERO_DEVIATION)


def _nuisances(model: Model, settings: EstimateSettings) -> Iterator[Nuisance]:
    for name, deviation in settings.offsets.items():
        if model.rest_parameter(name):
            continue
        unit, spread = _zero_deviation(name, deviation)
        covariate = settings.covariates.get(name, "")
        if covariate and covariate not in model.input_names:
            raise InputError(
                f"[estimate.covariates]: '{covariate}' is no input of model '{model.name}'; name one of "
                f"{', '.join(model.input_names)}"
            )
        yield Nuisance(InputCorrection(name, "zero"), Prior(0.0, spread, _SOURCE), unit, covariate=covariate)
    for name, deviation in settings.gains.items():
        yield Nuisance(InputCorrection(name, "gain"), Prior(1.0, deviation or _GAIN_DEVIATION, _SOURCE), "1")
    for name, deviation in settings.delays.items():
        if name in model.input_names and deviation != 0.0:  # no deviation at all: its timing is known
            spread = _DELAY_DEVIATION if deviation is None else deviation
            yield Nuisance(InputCorrection(name, "delay"), Prior(0.0, spread, _SOURCE), "s")


def _session_parameters(model: Model, settings: EstimateSettings) -> Iterator[tuple[str, Prior]]:
    """Yield the model parameters that each session has of its own: a current, and what states have at rest."""
    if settings.current > 0:
        prior = Prior(0.0, settings.current, _SOURCE)
        yield from (("current_north", prior), ("current_east", prior))
    for state, deviation in settings.offsets.items():
        if name := model.rest_parameter(state):
            yield name, Prior(model.parameters[name].value, _zero_deviation(state, deviation)[1], _SOURCE)


def output_error_problem(
    model: Model, runs: Runs, segment_s: float, settings: EstimateSettings, workers: int | None = None
) -> OutputError:
    """Return the runs in segments of `segment_s` [s] (infinite: whole runs) as an output-error problem.

    The noise of each channel is a tenth of its spread. Force points and carried information stand with the runs. Inputs
    are held between samples where the records hold them, and late by what their sample interval leaves open.

    Raises:
        InputError: a covariate that is no input, outputs that cannot be compared, time steps that differ, a record of
            fewer than three samples, or force points that the model cannot be compared with.
    """
    model = with_held_inputs(model, runs.records)
    own = tuple(_session_parameters(model, settings))
    model = model.with_parameters(model.parameters.fixed(*(name for name, _ in own)))
    outputs = compared_outputs(model, runs.records, settings.channels)
    data = cut_segments(model, runs.records, outputs, None if np.isinf(segment_s) else segment_s, runs.sessions)
    spread = np.nanstd(data.measured, axis=0)
    return OutputError(
        model,
        data,
        np.maximum(_NOISE_SHARE * spread, _LEAST_NOISE),
        (*_nuisances(model, settings), *timing_nuisances(model, runs.records, settings)),
        own,
        workers=workers,
        extra_terms=(*(StaticForces(model, points) for points in runs.forces), *runs.carried),
        prior_terms=tuple(joint_prior_term(model.parameters, prior) for prior in runs.joint_priors),
    )
