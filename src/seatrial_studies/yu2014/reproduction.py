"""Table 1 with what it leaves open fitted to it, histories of one sea, and the energy of roll and fins."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.optimize import least_squares

from seatrial.core.values import Array
from seatrial.physics.hydro import Complex, G
from seatrial.physics.loops import ActuatorDrive, Performance, Preamplifier, TransferLoop, reversals_per_hour
from seatrial.physics.sea import Spacing, WaveComponents, harmonic_sum, ittc, realise, short_crested
from seatrial_studies.yu2014.published import (
    DESIGN_ROW,
    DESIGN_SEA,
    HULL_FACTOR,
    KNOT,
    LOWER,
    PUBLISHED,
    PUBLISHED_VALUES,
    TABLE_1,
    UPPER,
    ControllerResult,
    RollResponse,
    SeaCondition,
    calibrated_K_q,
    effective_slope,
    performance,
    roll_response,
    stabiliser_loop,
)

# Table 1 with what it leaves open fitted to it: nothing here is reproduced, and no number is called so.

_UNSTABLE_LOG = 5.0
SPREADING = 1.0
# starts of the baseline's search beside the GA's gains: its residuals have several valleys
_BASELINE_STARTS = (PUBLISHED_VALUES, np.array([10.0, 5.0, 80.0]), np.array([10.0, 45.0, 5.0]))


@dataclass(frozen=True, eq=False)
class Table1Fit:
    """One reading of the preamplifier and one sense of the heading.

    Attributes:
        following_is_zero: whether 0 deg in table 1 is a following sea; else a head sea.
        K_q, level: fitted; genetic: the GA's column so made, (6, 3) as `Column.logs`.
        baseline: gains fitted to the traditional PID's column; traditional: that column, (6, 3).
    """

    preamplifier: Preamplifier
    following_is_zero: bool
    K_q: float
    level: float
    genetic: Array
    baseline: Array
    traditional: Array

    @property
    def log_error(self) -> float:
        """rms log error of the GA's column."""
        return _rms(self.genetic - _printed_logs()[0])

    @property
    def baseline_log_error(self) -> float:
        """rms log error of the traditional PID's column."""
        return _rms(self.traditional - _printed_logs()[1])

    @property
    def gains_at_bounds(self) -> int:
        """How many of the baseline's gains stand at a bound of the paper's box."""
        return int(np.sum((self.baseline < 0.001 * UPPER) | (self.baseline > 0.999 * UPPER)))

    def sea(self, heading: float, speed: float) -> SeaCondition:
        """Return a sea of table 1 as fitted."""
        return SeaCondition(speed, heading if self.following_is_zero else 180.0 - heading, spreading=SPREADING)

    def results(self, log_values: Array) -> list[ControllerResult]:
        """Return the rows of a fitted column."""
        return [self.row_result(log_values, row) for row in range(len(log_values))]

    def row_result(self, log_values: Array, row: int) -> ControllerResult:
        """Numbers of one row of `genetic` or `traditional`."""
        roll, rate, left = np.exp(log_values[row])
        return ControllerResult(float(roll), float(rate), 100.0 * (1.0 - float(left)))


def fit_table_1(preamplifier: Preamplifier, *, following_is_zero: bool) -> Table1Fit:
    """Fit K_q and the level to the GA's column, then the baseline's gains, by least squares of logarithms."""
    printed, traditional = _printed_logs()

    def residuals(x: Array) -> Array:
        return (
            _table_1_logs(
                _table_1_seas(preamplifier, math.exp(x[0]), following_is_zero), PUBLISHED_VALUES, math.exp(x[1])
            )
            - printed
        ).ravel()

    start = np.array([math.log(calibrated_K_q(preamplifier)), math.log(0.5)])
    found = least_squares(residuals, start, diff_step=(1e-4, 1e-4), xtol=1e-6)
    K_q, level = (float(v) for v in np.exp(found.x))
    seas = _table_1_seas(preamplifier, K_q, following_is_zero)
    baseline = _fit_baseline(seas, level, traditional)
    made, other = _table_1_logs(seas, PUBLISHED_VALUES, level), _table_1_logs(seas, baseline, level)
    return Table1Fit(preamplifier, following_is_zero, K_q, level, made, baseline, other)


def _fit_baseline(seas: list[Performance], level: float, printed: Array) -> Array:
    """Gains of the traditional PID within the paper's box."""

    def residuals(share: Array) -> Array:
        return (_table_1_logs(seas, LOWER + share * (UPPER - LOWER), level) - printed).ravel()

    found = [
        least_squares(residuals, np.clip((s - LOWER) / (UPPER - LOWER), 0.01, 0.99), bounds=(0.0, 1.0), xtol=1e-6)
        for s in _BASELINE_STARTS
    ]
    best = min(found, key=lambda result: float(result.cost))
    return LOWER + np.asarray(best.x) * (UPPER - LOWER)


def _table_1_seas(preamplifier: Preamplifier, K_q: float, following_is_zero: bool) -> list[Performance]:
    made = []
    for row in TABLE_1:
        heading = row.heading if following_is_zero else 180.0 - row.heading
        made.append(performance(preamplifier, SeaCondition(row.speed, heading, spreading=SPREADING), K_q))
    return made


def _table_1_logs(seas: list[Performance], gains: Array, level: float) -> Array:
    """Logarithms of roll, rate and what is left, (6, 3); far off where a loop is unstable."""
    return np.stack([_response_logs(roll_response(of, gains), level) for of in seas])


def _response_logs(response: RollResponse, level: float) -> Array:
    if not math.isfinite(response.Ms):
        return np.full(3, _UNSTABLE_LOG)
    return np.log([level * response.roll, level * response.rate, response.roll / response.uncontrolled])


def _printed_logs() -> tuple[Array, Array]:
    return np.stack([row.genetic.log_values for row in TABLE_1]), np.stack(
        [row.traditional.log_values for row in TABLE_1]
    )


def _rms(errors: Array) -> float:
    return math.sqrt(float(np.mean(errors**2)))


def best_fit_of(fits: tuple[Table1Fit, ...], preamplifier: Preamplifier) -> Table1Fit:
    """Return the sense of the heading with the smaller error."""
    return min((f for f in fits if f.preamplifier is preamplifier), key=lambda f: f.log_error)


# Time histories of one sea, as in figures 3 to 7, and how much one record of 1000 s can show.

# s, s and lines of the sea; our choice
DURATION, SAMPLE, LINES = 200.0, 0.25, 300


@dataclass(frozen=True, eq=False)
class RollHistories:
    """At 18 kn and 90 deg, all (n,); roll [deg] and fin rate [deg/s] at the fitted level.

    Attributes:
        uncontrolled: roll without fins.
        pid, genetic: (roll, fin rate) under the baseline and the paper's gains.
    """

    time: Array
    uncontrolled: Array
    pid: tuple[Array, Array]
    genetic: tuple[Array, Array]


def simulate_histories(fit: Table1Fit, seed: int) -> RollHistories:
    """The same waves for all three, in the sea fitted to table 1; steady motion, so that nothing is integrated."""
    rng = np.random.default_rng([seed, 6])
    sea = fit.sea(DESIGN_ROW.heading, DESIGN_ROW.speed)
    long = realise(
        ittc(PUBLISHED.height), sea.speed * KNOT, math.radians(sea.heading), rng, count=LINES, spacing=Spacing.JITTERED
    )
    lines = long if sea.spreading is None else short_crested(long, rng, sea.spreading)
    time = np.arange(0.0, DURATION, SAMPLE)
    made = stabiliser_loop(fit.preamplifier, sea.speed, fit.K_q)
    scale = math.degrees(fit.level)
    free = scale * response_to_slope(lines, made.disturbance.frequency_response(np.abs(lines.omega_e)), time)
    return RollHistories(
        time,
        free,
        _controlled_motion(made, fit.baseline, lines, time, scale),
        _controlled_motion(made, PUBLISHED_VALUES, lines, time, scale),
    )


def _controlled_motion(
    transfer_loop: TransferLoop, gains: Array, lines: WaveComponents, time: Array, scale: float
) -> tuple[Array, Array]:
    """Roll and fin rate."""
    made, w = transfer_loop.with_gains(gains), np.abs(lines.omega_e)
    roll = made.disturbance.frequency_response(w) / (1.0 + made.open_loop(w))
    rate = -1j * w * (made.gain_values @ made.controller_terms(w)) * roll
    return scale * response_to_slope(lines, roll, time), scale * response_to_slope(lines, rate, time)


def response_to_slope(lines: WaveComponents, operator: Complex, time: Array) -> Array:
    """Return the response (n,) to the effective wave slope; operators at |omega_e|, overtaken lines conjugated."""
    k = lines.omega**2 / G
    hull = np.array(
        [
            HULL_FACTOR.slope_factor(np.array([w]), float(b))[0]
            for w, b in zip(lines.omega, lines.direction, strict=True)
        ]
    )
    slope = 1j * k * np.sin(lines.direction) * hull * lines.amplitude
    ahead = np.where(lines.omega_e < 0.0, np.conj(slope), slope)
    return harmonic_sum(np.abs(lines.omega_e), operator * ahead, time)


def rms_variation(preamplifier: Preamplifier) -> float:
    """Coefficient of variation of the rms roll of one record of 1000 s under the paper's gains where they were set.

    Of a Gaussian process with one-sided spectrum S: var(s^2) = 2 pi / T int S^2 d omega, half of it relatively for s.
    """
    made, seen = performance(preamplifier).loop, effective_slope(DESIGN_SEA)
    w = seen.omega_e
    energy = np.abs(made.disturbance.frequency_response(w) / (1.0 + made.open_loop(w))) ** 2 * seen.energy
    squared = float(np.sum(energy**2 / np.gradient(w)))
    return 0.5 * math.sqrt(2.0 * math.pi / PUBLISHED.record_seconds * squared) / float(energy.sum())


# Energy, the paper's point: W in joules, what propulsion loses to fin drag and roll, reversals of the fins.

WATTS_PER_KILOWATT = 1000.0  # W, by definition
EFFICIENCY = 0.8  # eta of the fin drive, not printed; assumed: saved shares do not depend on it
SEA_WATER = 1025.0  # kg/m^3, density
GRAVITY = 9.80665  # m/s^2, standard
BLOCK_COEFFICIENT = 0.5  # of the assumed box of 100 x 10.5 x 3.4 m; assumed, a slender patrol ship
# roll radius of gyration with added mass over the breadth: C sqrt(g) / pi of T = 2 C B / sqrt(GM) with C = 0.373 +
# 0.023 B/d - 0.043 L/100 = 0.401 for 100 x 10.5 x 3.4 m (2008 IS Code, IMO resolution MSC.267(85), part A, 2.3)
GYRADIUS_SHARE = 0.4
PLANT_DAMPING = 0.3796  # s, coefficient of s of G_phi: 2 zeta T
PLANT_PERIOD_SQUARED = 1.43242  # s^2, coefficient of s^2 of G_phi
# drag coefficient of NACA 0015 at zero lift: Whicker & Fehlner 1958, DTMB Report 933, as later texts on fins quote it
PROFILE_DRAG = 0.0065
OSWALD = 0.9  # efficiency in C_L^2 / (0.9 pi a_e); Whicker & Fehlner 1958, quoted likewise


@dataclass(frozen=True)
class FinEnergy:
    """What one controller costs in one condition.

    Attributes:
        work: W of eq. (3), J.
        fin_power, roll_power: estimates of what propulsion loses to the drag of both fins and to roll, W; NaN where the
            motion that they need is not known.
        reversals: of the fins in an hour; NaN likewise.
    """

    work: float
    fin_power: float = math.nan
    roll_power: float = math.nan
    reversals: float = math.nan


@dataclass(frozen=True)
class EnergyComparison:
    """One row of table 1: the traditional PID and the GA, as printed and as fitted by us; ratios are GA over PID."""

    row: str
    printed_rate_ratio: float
    fitted_rate_ratio: float
    printed: tuple[FinEnergy, FinEnergy]
    fitted: tuple[FinEnergy, FinEnergy]

    @staticmethod
    def saved(pair: tuple[FinEnergy, FinEnergy]) -> float:
        """Return what the GA saves of W, per cent."""
        return 100.0 * (1.0 - pair[1].work / pair[0].work)


def work(rate: float) -> float:
    """Return W [J] of eq. (3) at an rms fin rate [deg/s]."""
    return ActuatorDrive(PUBLISHED.inertia, EFFICIENCY).energy(math.radians(rate) ** 2)


def lift_slope() -> float:
    """Return C_L per radian at twice the aspect ratio, the hull a mirror (Whicker & Fehlner 1958, eq. (1), linear)."""
    a = 2.0 * PUBLISHED.aspect
    return 1.8 * math.pi * a / (1.8 + math.sqrt(a**2 + 4.0))  # 1.8: 0.9 of 2 pi, over pi; unswept


def fin_drag_power(fin_rms: float, speed: float) -> float:
    """Return the mean power [W] that two fins of an rms angle [deg] drag at a speed [kn]: D U of both.

    C_D = C_D0 + C_L^2 / (0.9 pi a_e) (Whicker & Fehlner 1958, DTMB Report 933), mean over a Gaussian fin angle.
    """
    U = speed * KNOT
    C_L_squared = (lift_slope() * math.radians(fin_rms)) ** 2
    C_D = PROFILE_DRAG + C_L_squared / (OSWALD * math.pi * 2.0 * PUBLISHED.aspect)
    return 2.0 * 0.5 * SEA_WATER * U**3 * PUBLISHED.span * PUBLISHED.chord * C_D


def roll_power(roll_rate_rms: float) -> float:
    """Return the mean power [W] that roll damping dissipates at an rms roll rate [deg/s]: an upper bound of the loss.

    2 zeta T (Delta g GM) var(roll rate): the moment of damping times the rate (Himeno 1981, Prediction of Ship Roll
    Damping, University of Michigan, Department of Naval Architecture and Marine Engineering, Report 239).
    Waves feed the motion, so that the engine loses this at most. GM from the plant's period by a gyradius of 0.4 B.
    """
    hull = HULL_FACTOR
    mass = SEA_WATER * hull.L * hull.B * hull.T * BLOCK_COEFFICIENT
    inertia = mass * (GYRADIUS_SHARE * hull.B) ** 2
    restoring = inertia / PLANT_PERIOD_SQUARED  # N m/rad: T^2 is inertia over restoring
    return PLANT_DAMPING * restoring * math.radians(roll_rate_rms) ** 2


def fin_energy(loop_performance: Performance, gains: Array, speed: float, level: float = 1.0) -> FinEnergy:
    """Return the energy of gains in a sea; `level` multiplies all motions."""
    loop, w = loop_performance.loop, loop_performance.spectrum.omega_e
    roll = loop.disturbance.frequency_response(w) / (1.0 + loop.with_gains(gains).open_loop(w))
    fin = roll * (gains @ loop.controller_terms(w))

    def rms(response: Complex, power: int) -> float:
        energy = np.abs(response) ** 2 * loop_performance.spectrum.energy * np.abs(w) ** (2 * power)
        return level * math.degrees(math.sqrt(float(np.sum(energy))))

    rate = rms(fin, 1)
    return FinEnergy(
        work(rate), fin_drag_power(rms(fin, 0), speed), roll_power(rms(roll, 1)), reversals_per_hour(rate, rms(fin, 2))
    )


def compare_energy(fit: Table1Fit) -> tuple[EnergyComparison, ...]:
    """Return every row of table 1 as printed, and with the fitted loop, sea and baseline."""
    rows = []
    for row in TABLE_1:
        sea = fit.sea(row.heading, row.speed)
        of = performance(fit.preamplifier, sea, fit.K_q)
        fitted = tuple(fin_energy(of, gains, row.speed, fit.level) for gains in (fit.baseline, PUBLISHED_VALUES))
        rows.append(
            EnergyComparison(
                row.name,
                row.genetic.rate / row.traditional.rate,
                math.sqrt(fitted[1].work / fitted[0].work),
                (_printed(row.traditional), _printed(row.genetic)),
                (fitted[0], fitted[1]),
            )
        )
    return tuple(rows)


def _printed(column: ControllerResult) -> FinEnergy:
    return FinEnergy(work(column.rate))
