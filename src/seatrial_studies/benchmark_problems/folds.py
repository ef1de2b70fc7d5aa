"""Measured trials, a session left out: a model ship, a pond of sessions in wind, and a small craft with thrusters."""

from functools import cache, partial

import numpy as np

from seatrial.data.trial import Trial, TrialRecord, checked_records
from seatrial.estimation.predict import HoldoutProtocol
from seatrial.problems import BenchmarkProblem, Placement, ProblemDraw, fold_draw
from seatrial_studies.packaged_trials import packaged_trial

# evaluations, each a simulation of all training runs; chosen
_BUDGET = 500
_NOISE = "measured; the true coefficients are not known"


def kvlcc2_problems() -> tuple[BenchmarkProblem, ...]:
    """Return the folds of KVLCC2 in zigzags, run by run.

    Raises:
        InputError: the records are not here.
    """
    words = "KVLCC2, model of 7 m: MMG coefficients, one zigzag left out"
    source = "SIMMAN 2008 workshop, HSVA"
    return (_problem("kvlcc2-folds", "kvlcc2_hsva.toml", words, source, HoldoutProtocol(30.0, 6.0)),)


def esso_osaka_problems() -> tuple[BenchmarkProblem, ...]:
    """Return the folds of the Esso Osaka model in wind, day by day.

    Raises:
        InputError: as `kvlcc2_problems`.
    """
    words = "Esso Osaka, model of 3 m in wind: MMG coefficients, one day left out"
    source = "Wakita et al. 2022, doi 10.1007/s00773-021-00867-1"
    return (_problem("esso-folds", "esso_osaka.toml", words, source, HoldoutProtocol(50.0, 5.0)),)


def blueboat_problems() -> tuple[BenchmarkProblem, ...]:
    """Return the folds of the BlueBoat, run by run.

    Raises:
        InputError: as `kvlcc2_problems`.
    """
    words = "BlueBoat, 1.2 m, two thrusters: one run left out"
    source = "github jankristia/BlueBoatSystemIdentification"
    return (_problem("blueboat-folds", "blueboat.toml", words, source, HoldoutProtocol(10.0, 1.0)),)


def _problem(name: str, file: str, title: str, source: str, protocol: HoldoutProtocol) -> BenchmarkProblem:
    packaged_trial(file)
    return BenchmarkProblem(name, 1, title, source, _NOISE, _BUDGET, partial(_draw, file, protocol))


def _draw(file: str, protocol: HoldoutProtocol, rng: np.random.Generator, _: Placement) -> ProblemDraw:
    return fold_draw(*_records(file), protocol, rng)


@cache
def _records(file: str) -> tuple[Trial, tuple[TrialRecord, ...]]:
    """The trial and its records at the rate of its estimate, read once."""
    trial = packaged_trial(file)
    return trial, checked_records(trial).records
