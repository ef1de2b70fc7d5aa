"""A section's sway, heave and roll from a table of regular beam waves: potential theory and a few free corrections."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from seatrial.core.equations import Model
from seatrial.core.text.numbers import significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array, Index, InputError, Ship, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.estimation.information.covariance import inverse
from seatrial.physics.hydro import Complex, G, wavenumber
from seatrial.physics.hydro.section import MOTIONS, FloatingSection, SectionMotion
from seatrial.physics.models.section import AT_REST, section

CHANNELS = {SectionMotion.SWAY: "y0", SectionMotion.HEAVE: "z", SectionMotion.ROLL: "phi"}
"""Channel of each motion: sway to starboard, heave down, roll to starboard."""

# A table of responses: a run in regular waves a row.


@dataclass(frozen=True, eq=False)
class WaveResponses:
    """Motions in regular waves that come from port; time factor exp(+i omega t), crest at the centre line at t = 0.

    Attributes:
        name: of the table, for messages.
        omega: rad/s, (n,); wave_amplitude: m, (n,).
        motions: channel y0, z or phi -> complex amplitude per m of wave amplitude, (n,), NaN where not measured.
        relative_sd: channel -> relative standard deviation of each complex amplitude, (n,); 1 % where none is given.

    Raises:
        InputError: no row, a channel that is none of a section, columns of other lengths, or values that are none.
    """

    name: str
    omega: Array
    wave_amplitude: Array
    motions: Mapping[str, Complex]
    relative_sd: Mapping[str, Array] = field(default_factory=dict)

    def __post_init__(self) -> None:
        for channel in self.motions:
            if channel not in CHANNELS.values():
                hint = spelling_hint(channel, list(CHANNELS.values()))
                raise InputError(f"{self.name}: '{channel}' is no motion of a section{hint}; give y0, z or phi")
        columns = (self.omega, self.wave_amplitude, *self.motions.values(), *self.relative_sd.values())
        if len(set(map(len, columns))) != 1 or not self.motions:
            raise InputError(f"{self.name}: give each of its columns a value in each row")
        if not (np.all(self.omega > 0.0) and np.all(self.wave_amplitude > 0.0) and len(self.omega)):
            raise InputError(f"{self.name}: frequencies and wave amplitudes must be positive; leave other rows out")

    def rows(self, chosen: Index | NDArray[np.bool_]) -> "WaveResponses":
        """Return the table with the chosen rows, by number or by truth."""
        motions, spreads = (
            {c: values[chosen] for c, values in columns.items()} for columns in (self.motions, self.relative_sd)
        )
        return replace(self, omega=self.omega[chosen], wave_amplitude=self.wave_amplitude[chosen], motions=motions,
            relative_sd=spreads,
        )  # fmt: skip


def read_responses(path: str | Path) -> WaveResponses:
    """Read a table of responses from a CSV with a header; lines from `#` on are comment.

    Columns: `omega` [rad/s] or `period` [s], `wave_amplitude` [m], and for each motion y0 [m], z [m, down], phi [rad]
    either `z_amplitude`, `z_phase_deg` or `z_real`, `z_imag`, per m of wave amplitude, empty where not measured; and
    `z_sd`, relative.

    Raises:
        InputError: no such file, a column that is missing or unknown, and as `WaveResponses`.
    """
    import pandas as pd

    file = Path(path)
    if not is_file(file):
        raise InputError(f"there is no file {file} with responses; give the path of a CSV table")
    try:
        frame = pd.read_csv(file, comment="#", skipinitialspace=True)
        columns = {str(name).strip(): frame[name].to_numpy(dtype=np.float64) for name in frame.columns}
    except (ValueError, OSError) as error:
        raise InputError(f"{file.name} is not a table of numbers ({str(error).splitlines()[0]}); correct it") from None
    omega = columns.pop("omega", None)
    period = columns.pop("period", None)
    if (omega is None) is (period is None):
        raise InputError(f"{file.name} must have one of the columns omega [rad/s] and period [s]")
    amplitude = columns.pop("wave_amplitude", None)
    if amplitude is None:
        raise InputError(f"{file.name} has no column 'wave_amplitude' [m]; add it")
    motions, spreads = dict[str, Complex](), dict[str, Array]()
    for channel in CHANNELS.values():
        size, phase, real, imaginary = (
            columns.pop(f"{channel}_{part}", None) for part in ("amplitude", "phase_deg", "real", "imag")
        )
        if (spread := columns.pop(f"{channel}_sd", None)) is not None:
            spreads[channel] = spread
        if size is not None and phase is not None:
            motions[channel] = size * np.exp(1j * np.radians(phase))
        elif real is not None and imaginary is not None:
            motions[channel] = real + 1j * imaginary
        elif any(part is not None for part in (size, phase, real, imaginary)):
            raise InputError(
                f"{file.name}: '{channel}' lacks a column; give {channel}_amplitude and {channel}_phase_deg"
            )
    if columns:
        possible = [f"{c}_{part}" for c in CHANNELS.values() for part in ("amplitude", "phase_deg", "sd")]
        name = next(iter(columns))
        raise InputError(f"{file.name}: unknown column '{name}'{spelling_hint(name, possible)}; rename or remove it")
    return WaveResponses(file.name, 2.0 * np.pi / period if omega is None else omega, amplitude, motions, spreads)


# What is free: corrections of potential theory, forces beside it, and what instruments do to the responses.

_PLACES = {"22": (0, 0), "24": (0, 2), "33": (1, 1), "44": (2, 2)}
CORRECTIONS = tuple(f"{letter}{pair}" for letter in "abc" for pair in _PLACES)
RESISTANCES = tuple(f"{letter}{pair}" for letter in "df" for pair in ("22", "33", "44"))
INSTRUMENTS = (*(f"gain_{channel}" for channel in CHANNELS.values()), "delay", "distance")
COEFFICIENTS = (*CORRECTIONS, *RESISTANCES, *INSTRUMENTS)
"""What may be free or fixed, SI: a, b, c beside potential theory and hydrostatics, d quadratic damping, f dry friction;
gain of each channel over the motion, delay [s] of all channels behind the wave's, distance [m] of the section beyond
the place of the wave."""
_QUADRATIC, _DRY = 8.0 / (3.0 * np.pi), 4.0 / np.pi  # linear damping of equal work (Himeno 1981, eq. 3.4)
_SAME_DIGITS = 6  # of frequencies that are one; chosen
_RELATIVE_SD = 0.01  # repeatability of a run where none is stated; chosen
_ITERATIONS, _CLOSE = 400, 1e-10  # of the equivalent damping; relative change at which it ends; chosen
_DEPENDENT, _SHARE = 1e-7, 0.1  # smallest singular value over the largest; share of a direction; chosen
_TOGETHER = 0.99  # correlation; chosen


@dataclass(frozen=True, eq=False)
class _Theory:
    """Potential theory of a section at the frequencies of a table, (n, 3, 3) and (n, 3)."""

    section: FloatingSection
    table: WaveResponses
    is_free: tuple[bool, ...]
    depth: float
    added_mass: Array
    damping: Array
    excitation: Complex

    @classmethod
    def at_frequencies(
        cls, body: FloatingSection, table: WaveResponses, motions: Sequence[str], depth: float
    ) -> "_Theory":
        frequencies, place = np.unique(table.omega, return_inverse=True)
        hydrodynamics = [body.hydrodynamics(float(w)) for w in frequencies]
        arrays = (
            np.array([getattr(h, n) for h in hydrodynamics])[place] for n in ("added_mass", "damping", "excitation")
        )
        return cls(body, table, tuple(m.value in motions for m in MOTIONS), depth, *arrays)

    def motions(self, values: Mapping[str, float]) -> Complex:
        """Return the motions per m of wave amplitude, (n, 3); zero where the section is held.

        Quadratic damping and dry friction by the linear damping of equal work, 8 d V / 3 pi and 4 f / pi V at the
        amplitude V of velocity (Himeno 1981, eq. 3.4); V by iteration.
        """
        A, B, C = (letter_matrix(values, letter) for letter in "abc")
        omega, free = self.table.omega, np.flatnonzero(self.is_free)
        body = self.section
        inertia = np.diag(body.inertia) + self.added_mass + A
        rest = np.diag(body.stiffness) + C - omega[:, None, None] ** 2 * inertia
        linear = rest + 1j * omega[:, None, None] * (self.damping + B)
        d, f = (np.array([values.get(f"{letter}{p}", 0.0) for p in ("22", "33", "44")]) for letter in "df")
        moved = np.zeros((len(omega), 3), dtype=np.complex128)
        velocity = np.zeros((len(omega), 3))
        for _ in range(_ITERATIONS):
            equivalent = _QUADRATIC * d * velocity + _DRY * f / np.hypot(velocity, AT_REST)
            impedance = linear + 1j * omega[:, None, None] * (equivalent[:, :, None] * np.eye(3))
            inside = np.ix_(np.arange(len(omega)), free, free)
            moved[:, free] = np.linalg.solve(impedance[inside], self.excitation[:, free, None])[:, :, 0]
            now = np.abs(moved) * (omega * self.table.wave_amplitude)[:, None]
            if np.all(np.abs(now - velocity) <= _CLOSE * np.maximum(now, AT_REST)):
                break
            velocity = 0.5 * (velocity + now) if np.any(velocity) else now
        return moved

    def readings(self, values: Mapping[str, float]) -> Complex:
        """Return what the channels show of the motions, (n, 3)."""
        k = wavenumber(self.table.omega, self.depth)
        turned = np.exp(-1j * (k * values.get("distance", 0.0) + self.table.omega * values.get("delay", 0.0)))
        gains = np.array([values.get(f"gain_{channel}", 1.0) for channel in CHANNELS.values()])
        return self.motions(values) * gains * turned[:, None]


def letter_matrix(values: Mapping[str, float], letter: str) -> Array:
    """Return the symmetric matrix (3, 3) of the corrections of one letter."""
    matrix = np.zeros((3, 3))
    for pair, (i, j) in _PLACES.items():
        matrix[i, j] = matrix[j, i] = values.get(f"{letter}{pair}", 0.0)
    return matrix


# The fit: least squares on relative complex errors, and what the table leaves open.


@dataclass(frozen=True, eq=False)
class SectionFit:
    """A fitted section.

    Attributes:
        values: coefficient -> value, fixed ones included; errors: standard errors of the free ones.
        misfit: root mean square of the residuals over their standard deviation.
        open: sentences on what the table does not identify; empty where it identifies all.
    """

    section: FloatingSection
    motions: tuple[str, ...]
    depth: float
    values: Mapping[str, float]
    errors: Mapping[str, float]
    misfit: float
    open: tuple[str, ...]

    def predicted(self, table: WaveResponses) -> dict[str, Complex]:
        """Return what the channels would show in the waves of a table, per m of wave amplitude, channel -> (n,)."""
        readings = _Theory.at_frequencies(self.section, table, self.motions, self.depth).readings(self.values)
        return {CHANNELS[m]: readings[:, k] for k, m in enumerate(MOTIONS) if m.value in self.motions}

    def errors_of(self, table: WaveResponses) -> dict[str, tuple[Array, Array]]:
        """Return predicted over measured, channel -> per cent of amplitude and degrees of phase, each (n,)."""
        predicted = self.predicted(table)
        ratios = {c: predicted[c] / measured for c, measured in table.motions.items() if c in predicted}
        return {c: (100.0 * (np.abs(r) - 1.0), np.degrees(np.angle(r))) for c, r in ratios.items()}

    def model(self, omega: float) -> Model:
        """Return the model `section` with the coefficients of one frequency [rad/s], to simulate, export or tune on."""
        theory, body = self.section.hydrodynamics(omega), self.section
        total = {
            "a": theory.added_mass + letter_matrix(self.values, "a"),
            "b": theory.damping + letter_matrix(self.values, "b"),
            "c": np.diag(body.stiffness) + letter_matrix(self.values, "c"),
        }
        values = {f"{letter}{pair}": float(total[letter][place]) for letter in total for pair, place in _PLACES.items()}
        values |= {name: self.values[name] for name in RESISTANCES if name in self.values}
        values |= {f"s_{k}": float(m.value in self.motions) for k, m in enumerate(MOTIONS, 2)}
        values |= {"m": body.mass, "I_x": body.roll_inertia}
        return section().with_values(values, source=f"fit of a section in regular waves, at {omega:.4g} rad/s")


def fit_section(
    ship: Ship,
    table: WaveResponses,
    motions: Sequence[str],
    free: Sequence[str],
    fixed: Mapping[str, float] | None = None,
    depth: float = np.inf,
) -> SectionFit:
    """Fit free coefficients of a section to its responses; all others are zero (gains 1) unless they are fixed.

    Args:
        ship: particulars as `FloatingSection.from_ship` takes them.
        motions: in which the section is free, of sway, heave and roll; it is held in the others.
        free: names of `COEFFICIENTS` to estimate, begun at their fixed values, if any.
        fixed: values of others.
        depth: of the water [m], for the wave number only.

    Raises:
        InputError: an unknown motion or coefficient, a column of a motion that is held, a motion without a column, or
            unknowns that the table cannot identify.
    """
    from scipy.optimize import least_squares

    fixed = dict(fixed or {})
    _refuse_unknown(table, motions, (*free, *fixed))
    theory = _Theory.at_frequencies(FloatingSection.from_ship(ship), table, motions, depth)
    measured = np.column_stack([table.motions.get(c, np.full(len(table.omega), np.nan)) for c in CHANNELS.values()])
    is_measured = np.isfinite(measured) & np.array(theory.is_free)
    plain = np.full(len(table.omega), _RELATIVE_SD)
    spread = np.column_stack([table.relative_sd.get(c, plain) for c in CHANNELS.values()])[is_measured]
    count = 2 * len({(round(float(table.omega[i]), _SAME_DIGITS), j) for i, j in np.argwhere(is_measured)})
    if len(free) > count:
        raise InputError(
            f"{table.name}: {len(free)} unknowns cannot be identified from {count} numbers, two for each motion and "
            "wave period; fix some or add periods"
        )
    scales = np.array([_scale(theory, name) for name in free])
    start = np.array([fixed.get(n, 1.0 if n.startswith("gain_") else 0.0) for n in free]) / scales

    def values_at(point: Array) -> dict[str, float]:
        return fixed | dict(zip(free, (point * scales).tolist(), strict=True))

    def residuals(point: Array) -> Array:
        errors = (theory.readings(values_at(point))[is_measured] / measured[is_measured] - 1.0) / spread
        return np.concatenate([errors.real, errors.imag])

    solution = least_squares(residuals, start, x_scale="jac", xtol=_CLOSE, ftol=_CLOSE, gtol=_CLOSE)
    jacobian = np.asarray(solution.jac)
    _refuse_dependent(table, free, jacobian)
    variance = float(solution.fun @ solution.fun) / max(1, count - len(free))
    covariance = variance * inverse(jacobian.T @ jacobian) * np.outer(scales, scales)
    errors = dict(zip(free, np.sqrt(np.diag(covariance)).tolist(), strict=True))
    return SectionFit(
        theory.section, tuple(motions), depth, values_at(solution.x), errors,
        float(np.sqrt(np.mean(solution.fun**2))), tuple(_open(theory, free, covariance)),
    )  # fmt: skip


def _refuse_unknown(table: WaveResponses, motions: Sequence[str], names: Sequence[str]) -> None:
    """Refuse what is neither motion nor coefficient, and columns that do not go with the motions."""
    possible = [m.value for m in MOTIONS]
    for motion in motions:
        if motion not in possible:
            raise InputError(f"'{motion}' is no motion of a section{spelling_hint(motion, possible)}")
    for name in names:
        if name not in COEFFICIENTS:
            raise InputError(f"a section has no coefficient '{name}'{spelling_hint(name, list(COEFFICIENTS))}")
    for motion, channel in CHANNELS.items():
        if channel in table.motions and motion.value not in motions:
            raise InputError(
                f"{table.name} has '{channel}', but the section is held in {motion.value}: add '{motion.value}' to the "
                "motions or leave the column out"
            )
    if not any(CHANNELS[m] in table.motions for m in MOTIONS if m.value in motions):
        raise InputError(f"{table.name} has no column of {enumeration(motions)}; add one")


def _refuse_dependent(table: WaveResponses, free: Sequence[str], jacobian: Array) -> None:
    """Refuse unknowns that change nothing, or that together change nothing."""
    sizes = np.linalg.norm(jacobian, axis=0)
    silent = [name for name, size in zip(free, sizes, strict=True) if not size > 0.0]
    if silent:
        raise InputError(f"{table.name} does not show {enumeration(silent)}: fix them")
    _, values, directions = np.linalg.svd(jacobian / sizes, full_matrices=False)
    if values[-1] < _DEPENDENT * values[0]:
        together = [n for n, share in zip(free, directions[-1], strict=True) if abs(share) > _SHARE]
        raise InputError(
            f"{table.name} does not identify {enumeration(together)}: they change the responses together alike; fix one"
        )


def _open(theory: _Theory, free: Sequence[str], covariance: Array) -> Iterator[str]:
    """Yield what the table leaves open: coefficients no better known than guessed, and pairs known only together."""
    errors = np.sqrt(np.diag(covariance))
    for name, error in zip(free, errors, strict=True):
        if error > (size := _scale(theory, name)):
            yield f"{name} is not identified: its standard error {significant(error, 2)} exceeds {significant(size, 2)}"
    for i, j in combinations(range(len(free)), 2):
        correlation = covariance[i, j] / (errors[i] * errors[j])
        if abs(correlation) > _TOGETHER:
            yield f"{free[i]} and {free[j]} are known only together (correlation {correlation:.3f}); fix one"


def _scale(theory: _Theory, name: str) -> float:
    """Return the size of a coefficient that would be of the order of all that it stands beside."""
    body, middle = theory.section, float(np.median(theory.table.omega))
    letter, pair = name[0], name[1:]
    if pair not in _PLACES:
        return {"delay": 1.0 / middle, "distance": G / middle**2}.get(name, 1.0)
    i, j = _PLACES[pair]
    inertia = float(np.sqrt(body.inertia[i] * body.inertia[j]))
    velocity = middle * float(np.median(theory.table.wave_amplitude)) / (body.form.beam if pair == "44" else 1.0)
    damping = inertia * middle
    sizes = {"a": inertia, "b": damping, "c": damping * middle, "d": damping / velocity, "f": damping * velocity}
    return sizes[letter]
