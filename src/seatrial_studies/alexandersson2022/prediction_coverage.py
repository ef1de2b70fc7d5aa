"""What the intervals are worth: the turns' beside MARIN's circles, the bands of 30 s windows beside the records."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import CandidateModel, Check, Fit, Table
from seatrial.core.values import InputError
from seatrial.data.trial import TrialRecord
from seatrial.estimation.estimate import Estimation
from seatrial.estimation.identify import HOLDOUT_WINDOW_SHIP_LENGTHS
from seatrial.estimation.predict import HoldoutProtocol, measure_intervals
from seatrial.physics.manoeuvres import programme
from seatrial.physics.simulate import SOLAS_SLEW_RATE, manoeuvre
from seatrial_studies.alexandersson2022.published import MEASURED_TURNS, SIDES
from seatrial_studies.alexandersson2022.window_bands import BandCoverage, band_coverage, holdout_windows

# s, length of the windows that are predicted; our choice
WINDOW_S = 30.0
# limits of our checks: half width [%], shares of samples inside 95 % bands, least share of headings of Z_35_05
HALF_WIDTH_LIMIT, SHARE_LIMITS, HELD_OUT_SHARE = 10.0, (0.88, 0.99), 0.80
_LIMITED_MEASURES = ("tactical diameter",)
_MEASURES = {"advance_L": ("advance", "advance"), "tactical_diameter_L": ("tactical diameter", "diameter")}


@dataclass(frozen=True)
class TurnInterval:
    """A measure of a simulated turn with its interval, and MARIN's value, in ship lengths."""

    side: str
    measure: str
    lower: float
    upper: float
    measured: float

    @property
    def half_width(self) -> float:
        """Return the half width in per cent of the interval's middle."""
        return 100.0 * (self.upper - self.lower) / (self.upper + self.lower)

    @property
    def relative_deviation(self) -> float:
        """Return the distance of MARIN's value from the middle over the half width; 1 at the interval's end."""
        return abs(2.0 * self.measured - self.lower - self.upper) / (self.upper - self.lower)

    @property
    def contains_measured(self) -> bool:
        """Return whether the measured value lies inside."""
        return self.lower <= self.measured <= self.upper


@dataclass(frozen=True)
class PredictionCoverage:
    """Intervals of the turns, and shares of samples inside their bands: runs left out, and held out.

    with_tied: intervals of the turns by full refits and the spread of tied models; family: those models; both empty in
    the quick version.
    """

    turn_intervals: tuple[TurnInterval, ...]
    left_out_coverage: tuple[BandCoverage, ...]
    held_out_coverage: tuple[BandCoverage, ...]
    tied_turn_intervals: tuple[TurnInterval, ...] = ()
    family: tuple[CandidateModel, ...] = ()

    @property
    def heading_share(self) -> float:
        """Return the mean share of headings over the runs left out."""
        return float(np.mean([c.shares["psi"] for c in self.left_out_coverage]))


def assess_coverage(
    fit: Fit,
    tied_fit: Fit | None,
    estimation: Estimation,
    train: Sequence[TrialRecord],
    validation: Sequence[TrialRecord],
    approach: Mapping[str, float],
    seed: int,
) -> PredictionCoverage:
    """Steer the turns with ships beside the fit, and beside the one with the spread of tied models; predict windows.

    Raises:
        InputError: the turns diverge, or there are too few runs to leave any out.
    """
    within, beyond = band_coverage(
        holdout_windows(estimation, train, validation, HoldoutProtocol(window_s=WINDOW_S), seed)
    )
    turns, with_tied = (
        tuple(m for side in SIDES for m in simulated_turn_intervals(one, side, approach)) if one else ()
        for one in (fit, tied_fit)
    )
    return PredictionCoverage(turns, within, beyond, with_tied, tied_fit.candidate_models if tied_fit else ())


def simulated_turn_intervals(fit: Fit, side: str, approach: Mapping[str, float]) -> list[TurnInterval]:
    """Return the advance and tactical diameter of the 35 deg turn to one side.

    Raises:
        InputError: the fit has no margin, or most ships beside it cannot be steered through the turn.
    """
    if fit.interval_basis is None:
        raise InputError("this fit says nothing of its predictions' uncertainty; identify again")
    held = {name: value for name, value in approach.items() if name in fit.model.input_names}
    slew = SOLAS_SLEW_RATE * math.sqrt(fit.ship.scale)
    orders = programme(f"turning-circle:35:{side}")
    intervals = measure_intervals(
        fit.model,
        fit.interval_basis,
        lambda ship: manoeuvre(ship, orders, inputs=held, slew_rate=slew),
        fit.ship.length,
    )
    return [
        TurnInterval(side, name, *interval, float(getattr(MEASURED_TURNS[side], field)))
        for key, (name, field) in _MEASURES.items()
        if (interval := intervals.get(key)) is not None  # None: not determined
    ]


def tables(coverage: PredictionCoverage) -> tuple[Table, ...]:
    """The intervals of the turns, the shares of samples inside their bands, and the family where it was fitted."""
    turned = tuple(
        (
            f"{m.measure}, {m.side}",
            how,
            m.lower,
            m.upper,
            m.half_width,
            m.measured,
            "inside" if m.contains_measured else "outside",
        )
        for how, turns in (
            ("one-step jackknife", coverage.turn_intervals),
            ("jackknife, tied models", coverage.tied_turn_intervals),
        )
        for m in turns
    )
    rows: list[tuple[str | float | None, ...]] = [
        (c.run, c.windows, *(100.0 * c.shares[s] for s in ("psi", "x0", "y0")))
        for c in (*coverage.left_out_coverage, *coverage.held_out_coverage)
    ]
    rows.insert(
        len(coverage.left_out_coverage), ("mean of the runs left out", None, 100.0 * coverage.heading_share, None, None)
    )
    return (
        Table(
            "Intervals of the 35 deg turns",
            ("measure", "interval by", "from [L]", "to [L]", "half width [%]", "MARIN [L]", "MARIN's value"),
            turned,
            "95 % intervals: scatter of runs left out times the factor by which their errors exceed it (the default of "
            "seatrial identify); with full refits and the spread of tied models (--intervals jackknife) unless quick.",
        ),
        Table(
            f"Samples inside their 95 % bands, windows of {WINDOW_S:g} s",
            ("run", "windows", "heading [%]", "x0 [%]", "y0 [%]"),
            tuple(rows),
            "Each training run is predicted by the model without it (one-step jackknife), and its model discrepancy is "
            "that of the others; the last row is the run held out from everything.",
        ),
        *((family_table(coverage.family),) if coverage.family else ()),
    )


def family_table(members: Sequence[CandidateModel]) -> Table:
    """What each model of the family misses of runs left out."""
    rows = tuple(
        (
            m.name,
            m.free_count,
            m.heading_deg,
            m.position_m,
            "the trial's" if m.is_chosen else "tied" if m.is_tied else m.note,
        )
        for m in members
    )
    return Table(
        "The family of models on runs left out",
        ("model", "free coefficients", "heading rms [deg]", "position rms [m]", "standing"),
        rows,
        f"Windows of {HOLDOUT_WINDOW_SHIP_LENGTHS:g} ship lengths, one-step jackknife. Tied models are not "
        "worse than the best "
        "one beyond the scatter over runs; the trial's own model need not be among them, and none is chosen here.",
    )


def checks(coverage: PredictionCoverage) -> tuple[Check, ...]:
    """Return the half widths of the tactical diameters, shares inside the bands."""
    low, high = SHARE_LIMITS
    widths = [(m.side, m.half_width) for m in coverage.turn_intervals if m.measure in _LIMITED_MEASURES]
    held = float(np.mean([c.shares["psi"] for c in coverage.held_out_coverage]))
    widths += [
        (f"{m.side}, with tied models", m.half_width)
        for m in coverage.tied_turn_intervals
        if m.measure in _LIMITED_MEASURES
    ]
    return (
        *(
            Check(f"tactical diameter to {side}, half width [%]", width, HALF_WIDTH_LIMIT, width <= HALF_WIDTH_LIMIT)
            for side, width in widths
        ),
        Check(
            "headings inside their band, runs left out",
            coverage.heading_share,
            f"{low:g} to {high:g}",
            low <= coverage.heading_share <= high,
        ),
        Check("headings inside their band, Z_35_05", held, f"{HELD_OUT_SHARE:g} or more", held >= HELD_OUT_SHARE),
    )
