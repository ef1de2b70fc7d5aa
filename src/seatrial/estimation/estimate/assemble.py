"""Runs and settings put together as an output-error problem."""

from collections.abc import Iterator

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import NOTATION, InputError, Prior
from seatrial.data.trial import EstimateSettings
from seatrial.estimation.estimate.joint_prior import joint_prior_term
from seatrial.estimation.estimate.runs import Runs
from seatrial.estimation.estimate.timing import timing_nuisances, with_held_inputs
from seatrial.estimation.problem.output_error import Nuisance, OutputError
from seatrial.estimation.problem.segments import compared_outputs, cut_segments
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.physics.simulate.batch import InputCorrection
from seatrial.physics.simulate.states import rest_parameter

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
        if rest_parameter(model, name):
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
        if name := rest_parameter(model, state):
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
