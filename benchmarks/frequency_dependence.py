"""What constant coefficients are worth when the truth remembers: hull by panels, motions with memory, constants fitted.

A Wigley hull of the qi2025 ship's dimensions through Capytaine (extra `hydro`), its motions by Cummins' equation, the
constants of `heave_pitch` fitted to them. The range that they represent is where 90 % of the motions' power lies. For
each speed and heading: the constants against added mass and damping in that range and outside, the error of heave and
pitch per wave, and of their rms in seas of other periods.

Errors of coefficients are shares of the largest true value in the range, for true damping goes to zero at either end.
Abeam a hull alike fore and aft does not pitch: only heave is fitted there, with a33 and b33.
"""

import math
import sys
from dataclasses import dataclass

import numpy as np
from cummins import RetardationFunctions, retardation_functions, simulate_cummins
from hull_panels import solve_hull, wigley
from measure import Line, at_least, machine

from seatrial.core.equations import Model
from seatrial.core.values import Array, Channel, InputError, Record, RecordKind, frozen
from seatrial.estimation.identify.waves import transfer_functions
from seatrial.estimation.information.frequency_response import frequency_range
from seatrial.estimation.problem.output_error import OutputError
from seatrial.estimation.problem.segments import cut_segments
from seatrial.numerics.optimise import Status, levenberg_marquardt
from seatrial.physics.hydro.capytaine_data import HullData, HullExcitation
from seatrial.physics.hydro.excitation import Complex, encounter_frequency
from seatrial.physics.hydro.tabulated import coefficients_at_speed
from seatrial.physics.models.heave_pitch import heave_pitch
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial.physics.models.published import physical_start_values
from seatrial.physics.sea.realise import WaveComponents, harmonic_sum, realise
from seatrial.physics.sea.spectrum import Spectrum, bretschneider, ittc, jonswap

L, B, T, RHO = 60.0, 7.14, 2.27, 1025.0
DT, FINE, DURATION = 0.1, 0.02, 240.0
SEA, SWELL = ittc(2.27), jonswap(1.5, 9.0, gamma=7.0)
CASES = (*((U, heading, SEA) for U in (0.0, 5.0, 9.26) for heading in (180, 135, 90)), (0.0, 180, SWELL))
# peak periods of the seas predicted, s; the fitted one has 7.5
OTHERS = (5.5, 10.0)
NOISE = np.array([0.01, math.radians(0.02)])
HIGHEST, HIGHEST_MET = 2.6, 6.0  # rad/s, of the waves and of encounter
CLOSE = 0.05


def hull() -> HullData:
    """Panels fine enough for the shortest wave met."""
    omega = np.linspace(0.25, 3.4, 26)
    return solve_hull(wigley(L, B, T, along=70, down=6), omega, np.radians([90.0, 135.0, 180.0]), rho=RHO)


def ship(data: HullData) -> Model:
    """The hull floating level, pitch radius a quarter of its length."""
    m = data.stiffness[0, 0] / (RHO * 9.81) * T * RHO * 2.0 / 3.0
    (c33, c35), (c53, c55) = data.stiffness
    known = {"m": m, "I5": m * (0.25 * L) ** 2, "c33": c33, "c35": c35, "c53": c53, "c55": c55}
    return heave_pitch().with_values({**known, **physical_start_values(known)})


def simulate_with_memory(data: HullData, memory: RetardationFunctions, model: Model, lines: WaveComponents) -> Record:
    """Motions with memory in the waves of the lines, recorded at 10 Hz with sensor noise."""
    time = np.arange(round(DURATION / FINE) + 1, dtype=np.float64) * FINE
    amplitude = lines.forces(HullExcitation(data))
    forces = np.stack([harmonic_sum(lines.omega_e, amplitude[:, j], time) for j in (0, 1)], axis=1)
    mass = np.diag([model.parameters["m"].value, model.parameters["I5"].value])
    states = simulate_cummins(memory, mass, data.stiffness, lines.U, forces)
    kept = slice(None, None, round(DT / FINE))
    noise = np.random.default_rng(1).standard_normal((len(time[kept]), 2)) * NOISE
    made = {"F3": forces[kept, 0], "M5": forces[kept, 1],
            "z": -states[kept, 0] + noise[:, 0], "theta": -states[kept, 2] + noise[:, 1]}  # fmt: skip
    channels = {name: Channel.from_notation(name, frozen(values)) for name, values in made.items()}
    return Record("memory", frozen(time[kept]), channels, RecordKind.SIMULATED).between(20.0, DURATION)


@dataclass(frozen=True, eq=False)
class Case:
    """One fit: the simulated case, the constants, and the range of frequencies that the motions show.

    Attributes:
        outputs: motions fitted; names: coefficients fitted; errors: their standard errors by the fit's own account.
        misfit: rms of what the fit leaves over that of the motions, both in standard deviations of the sensors.
    """

    name: str
    lines: WaveComponents
    fitted: Model
    outputs: tuple[str, ...]
    names: tuple[str, ...]
    errors: Array
    status: Status
    misfit: float
    first: float
    last: float

    @property
    def values(self) -> Array:
        """The constants fitted, in the order of `names`."""
        return np.array([self.fitted.parameters[n].value for n in self.names])


@dataclass(frozen=True, eq=False)
class ShipWithMemory:
    """The ship with memory."""

    data: HullData
    memory: RetardationFunctions
    model: Model

    def coefficients(self, names: tuple[str, ...], omega: Array, U: float) -> Array:
        """Those named at frequencies of encounter, (n, names), as the memory means them."""
        A, damping = coefficients_at_speed(*self.memory.coefficients(omega), omega, U)
        index = {"3": 0, "5": 1}
        part = {"a": A, "b": damping}
        return np.stack([part[n[0]][:, index[n[1]], index[n[2]]] for n in names], axis=1)

    def forces(self, omega: Array, U: float, beta: float) -> Complex:
        """F3 and M5 per metre of wave, (n, 2)."""
        return np.asarray(np.stack(HullExcitation(self.data).forces(omega, U, beta), axis=1), dtype=np.complex128)

    def operators(self, omega: Array, U: float, beta: float) -> Complex:
        """Heave [up] and pitch [bow down] per metre of wave, (2, n)."""
        omega_e = encounter_frequency(omega, U, beta)
        A, damping = coefficients_at_speed(*self.memory.coefficients(omega_e), omega_e, U)
        mass = np.diag([self.model.parameters["m"].value, self.model.parameters["I5"].value])
        Z = -(omega_e**2)[:, None, None] * (mass + A) + 1j * omega_e[:, None, None] * damping + self.data.stiffness
        motion = np.linalg.solve(Z, self.forces(omega, U, beta)[:, :, None])[:, :, 0]
        return np.asarray(motion.T, dtype=np.complex128)

    def sea(self, spectrum: Spectrum, U: float, beta: float, seed: int) -> WaveComponents:
        """The waves of a sea that the panels carry and the memory's step follows."""
        q = -U * math.cos(beta) / 9.81
        met = HIGHEST_MET if q < 1e-9 else (math.sqrt(1.0 + 4.0 * q * HIGHEST_MET) - 1.0) / (2.0 * q)
        band = (spectrum.band()[0], min(HIGHEST, met))
        return realise(spectrum, U, beta, np.random.default_rng(seed), band=band)


def fit_constants(truth: ShipWithMemory, U: float, heading: int, spectrum: Spectrum) -> Case:
    """The constants that fit the motions best, from the physics start and the true ones at five frequencies.

    There are several minima; the lowest need not be one that has converged, nor physical.
    """
    outputs, names = (("z",), ("a33", "b33")) if heading == 90 else (("z", "theta"), COEFFICIENTS)
    lines = truth.sea(spectrum, U, math.radians(heading), 0)
    record = simulate_with_memory(truth.data, truth.memory, truth.model, lines)
    band = frequency_range([record], outputs)
    first, last = min(a for a, _ in band.values()), max(b for _, b in band.values())
    model = truth.model.with_parameters(truth.model.parameters.only_free(names))
    noise = NOISE[: len(outputs)]
    problem = OutputError(model, cut_segments(model, [record], outputs, None), noise)
    within = truth.coefficients(names, np.linspace(first, last, 5), U)
    found = min(
        (levenberg_marquardt(problem, start, problem.measured_initial_states(), evaluations=400)
         for start in (problem.start(), *within)),
        key=lambda optimum: optimum.solution.value,
    )  # fmt: skip
    constants = dict(zip(names, map(float, found.solution.point), strict=True))
    errors = np.sqrt(np.diag(np.linalg.inv(found.normal.without_local()[1])))
    power = sum((float(np.std(record[c])) / float(sd)) ** 2 for c, sd in zip(outputs, noise, strict=True))
    misfit = math.sqrt(2.0 * found.solution.value / len(record) / power)
    name = f"{U:.3g} m/s, {heading} deg, {spectrum.name}"
    return Case(name, lines, model.with_values(constants), outputs, names, errors, found.solution.status, misfit,
                first, last)  # fmt: skip


def is_physical(model: Model) -> bool:
    """Whether ship and added mass together resist every acceleration."""
    m, I5, a33, a35, a53, a55 = (model.parameters[n].value for n in ("m", "I5", "a33", "a35", "a53", "a55"))
    return m + a33 > 0.0 and (m + a33) * (I5 + a55) > (0.5 * (a35 + a53)) ** 2


def operator_errors(truth: ShipWithMemory, case: Case, omega: Array) -> tuple[Complex, Complex]:
    """Error of the constants' heave and pitch per metre of wave, and the true ones, (outputs, n)."""
    U, beta = case.lines.U, float(case.lines.direction[0])
    true = truth.operators(omega, U, beta)
    made = np.stack(transfer_functions(case.fitted, encounter_frequency(omega, U, beta), truth.forces(omega, U, beta)))
    return (made - true)[: len(case.outputs)], true[: len(case.outputs)]


def comparison_frequencies(case: Case) -> Array:
    """Frequencies of encounter: below the range, five in it, above."""
    return np.array([0.6 * case.first, *np.linspace(case.first, case.last, 5), 1.4 * case.last])


def lines_of(truth: ShipWithMemory, case: Case) -> list[Line]:
    """What the constants of a case are worth, in numbers."""
    grid, ends = np.linspace(case.first, case.last, 60), comparison_frequencies(case)[[0, -1]]
    inside = truth.coefficients(case.names, grid, case.lines.U)
    off = np.abs(case.values - inside)
    largest = np.abs(inside).max(axis=0)
    outside = np.abs(case.values - truth.coefficients(case.names, ends, case.lines.U)) / largest
    own = [j for j, n in enumerate(case.names) if n[1] == n[2]]
    made = [
        Line("motions show from", case.first, "rad/s"),
        Line("motions show to", case.last, "rad/s"),
        at_least("fit converged (1 yes, 0 no)", float(case.status.is_success), "", 1.0),
        at_least("mass matrix positive definite (1 yes, 0 no)", float(is_physical(case.fitted)), "", 1.0),
        Line("fit leaves, of the motions' rms", 100.0 * case.misfit, "%"),
        Line("share of the range in which a, b lie within 5 %", 100.0 * float(np.mean((off < CLOSE * largest)[:, own])),
             "%"),
        Line("... within the fit's own 95 % interval", 100.0 * float(np.mean((off < 1.96 * case.errors)[:, own])), "%"),
    ]  # fmt: skip
    for j in own:
        made.append(
            Line(f"{case.names[j]} off in the range, mean", 100.0 * float(np.mean(off[:, j] / largest[j])), "%")
        )
        made += [Line(f"{case.names[j]} off at {w:.2f} rad/s, {where}", 100.0 * float(outside[i, j]), "%")
                 for i, (w, where) in enumerate(zip(ends, ("below", "above"), strict=True))]  # fmt: skip
    return made + per_wave(truth, case) + predictions(truth, case)


def per_wave(truth: ShipWithMemory, case: Case) -> list[Line]:
    """Largest error of heave and pitch per wave, in the range and outside."""
    waves = np.linspace(case.lines.omega[0], case.lines.omega[-1], 120)
    met = np.abs(encounter_frequency(waves, case.lines.U, case.lines.direction[0]))
    error, true = operator_errors(truth, case, waves)
    share = 100.0 * np.abs(error) / np.abs(true).max(axis=1, keepdims=True)
    within = (met >= case.first) & (met <= case.last)
    named = zip(("heave", "pitch"), share, strict=False)
    return [
        Line(f"{motion} per wave off {where}", float(of[there].max()), "% of max")
        for motion, of in named
        for where, there in (("in the range", within), ("outside", ~within))
        if np.any(there)
    ]


def predictions(truth: ShipWithMemory, case: Case) -> list[Line]:
    """rms of the error over rms of the motion in a new draw of the same height, of other peak periods."""
    made = []
    for period in (7.5, *OTHERS):
        lines = truth.sea(bretschneider(2.27, period), case.lines.U, float(case.lines.direction[0]), 1)
        error, true = operator_errors(truth, case, lines.omega)
        power = np.sum(np.abs(np.stack([error, true]) * lines.amplitude) ** 2, axis=2)
        made += [Line(f"{motion} predicted in a sea of {period:g} s, error", 100.0 * math.sqrt(e / t), "% of rms")
                 for motion, e, t in zip(("heave", "pitch"), *power, strict=False)]  # fmt: skip
    return made


def table(truth: ShipWithMemory, case: Case) -> str:
    """Frequency, then true and constant value of each coefficient of its own motion."""
    omega = comparison_frequencies(case)
    own = [j for j, n in enumerate(case.names) if n[1] == n[2]]
    true = truth.coefficients(case.names, omega, case.lines.U)
    header = "  rad/s" + "".join(f"{case.names[j]:>11} {'constant':>10}" for j in own)
    rows = [f"{w:7.2f}" + "".join(f"{true[i, j]:11.3g} {case.values[j]:10.3g}" for j in own)
            for i, w in enumerate(omega)]  # fmt: skip
    return "\n".join(f"    {row}" for row in (header, *rows))


def run(*, tables: bool = False) -> list[Line]:
    """All cases; prints the tables of coefficients as it goes, if wanted.

    Raises:
        InputError: Capytaine is not installed.
    """
    data = hull()
    truth = ShipWithMemory(data, retardation_functions(data, FINE, 30.0), ship(data))
    made: list[Line] = []
    for U, heading, spectrum in CASES:
        case = fit_constants(truth, U, heading, spectrum)
        if tables:
            print(f"  {case.name}\n{table(truth, case)}", flush=True)
        made += [Line(f"{case.name}: {n.quantity}", n.value, n.unit, n.target, n.holds) for n in lines_of(truth, case)]
    return made


if __name__ == "__main__":
    print(machine())
    try:
        result = run(tables=True)
    except InputError as e:
        sys.exit(str(e))
    for line in result:
        print(f"  {line.quantity:<86} {line.value:>8.3g} {line.unit} {line.verdict}")
