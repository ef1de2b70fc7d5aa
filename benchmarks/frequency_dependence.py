"""What constant coefficients are worth when the truth remembers: hull by panels, motions with memory, constants fitted.

A Wigley hull of the qi2025 ship's dimensions through Capytaine (extra `hydro`), her motions by Cummins' equation, the
eight constants of `heave_pitch` fitted to them. For each speed and heading: the band of frequencies that the motions
show, the constants against added mass and damping there and outside, and the error of heave and pitch per wave.
"""

import math
from collections.abc import Sequence

import numpy as np
from measure import Line, machine

from seatrial.equations import Model
from seatrial.hydro.capytaine_data import HullData, HullExcitation
from seatrial.hydro.cummins import Memory, memory_of, simulate_memory
from seatrial.hydro.mesh import solve_hull, wigley
from seatrial.hydro.strip_theory import at_speed
from seatrial.identify.seakeeping import operators
from seatrial.information.frequency_range import frequency_range
from seatrial.models.heave_pitch import COEFFICIENTS, heave_pitch, physics_start
from seatrial.optimise import levenberg_marquardt
from seatrial.problem.output_error import OutputError
from seatrial.problem.segments import cut
from seatrial.sea.encounter import encounter_frequency
from seatrial.sea.realise import Lines, harmonic_sum, realise
from seatrial.sea.spectrum import Spectrum, bretschneider, ittc
from seatrial.values import Array, Channel, Kind, Record, frozen

L, B, T, RHO = 60.0, 7.14, 2.27, 1025.0
DT, FINE, DURATION = 0.1, 0.02, 240.0
CASES = ((0.0, 180), (5.0, 135), (9.26, 180), (9.26, 135), (9.26, 90))
NOISE = np.array([0.01, math.radians(0.02)])


def hull() -> HullData:
    """Panels fine enough for the shortest wave met."""
    omega = np.linspace(0.25, 3.4, 26)
    return solve_hull(wigley(L, B, T, along=70, down=6), omega, np.radians([90.0, 135.0, 180.0]), rho=RHO)


def ship(data: HullData) -> Model:
    """The hull floating level, pitch radius a quarter of her length."""
    m = data.stiffness[0, 0] / (RHO * 9.81) * T * RHO * 2.0 / 3.0
    (c33, c35), (c53, c55) = data.stiffness
    known = {"m": m, "I5": m * (0.25 * L) ** 2, "c33": c33, "c35": c35, "c53": c53, "c55": c55}
    return heave_pitch().with_values({**known, **physics_start(known)})


def sailed(data: HullData, memory: Memory, model: Model, lines: Lines) -> Record:
    """Motions with memory in the waves of the lines, recorded at 10 Hz with sensor noise."""
    time = np.arange(round(DURATION / FINE) + 1) * FINE
    amplitude = lines.forces(HullExcitation(data))
    forces = np.stack([harmonic_sum(lines.encounter, amplitude[:, j], time) for j in (0, 1)], axis=1)
    mass = np.diag([model.parameters["m"].value, model.parameters["I5"].value])
    states = simulate_memory(memory, mass, data.stiffness, lines.U, forces)
    kept = slice(None, None, round(DT / FINE))
    noise = np.random.default_rng(1).standard_normal((len(time[kept]), 2)) * NOISE
    made = {"F3": forces[kept, 0], "M5": forces[kept, 1],
            "z": -states[kept, 0] + noise[:, 0], "theta": -states[kept, 2] + noise[:, 1]}  # fmt: skip
    channels = {name: Channel.of(name, frozen(values)) for name, values in made.items()}
    return Record("memory", frozen(time[kept]), channels, Kind.SIMULATED).between(20.0, DURATION)


def constants(model: Model, record: Record) -> Model:
    """The model with the eight constants that fit the record."""
    problem = OutputError(model, cut(model, [record], ("z", "theta"), None), NOISE)
    found = levenberg_marquardt(problem, problem.start(), problem.measured_starts())
    return model.with_values(dict(zip(COEFFICIENTS, map(float, found.solution.point), strict=True)))


def changing(memory: Memory, omega: Array, U: float) -> Array:
    """The eight coefficients at the frequencies of encounter, (n, 8), as the memory means them."""
    A, damping = at_speed(*memory.coefficients(omega), omega, U)
    return np.stack([A[:, 0, 0], A[:, 0, 1], A[:, 1, 1], A[:, 1, 0],
                     damping[:, 0, 0], damping[:, 0, 1], damping[:, 1, 1], damping[:, 1, 0]], axis=1)  # fmt: skip


def true_operators(data: HullData, memory: Memory, model: Model, omega: Array, lines: Lines) -> tuple[Array, Array]:
    """Heave and pitch per metre of wave with memory, complex."""
    omega_e = encounter_frequency(omega, lines.U, lines.direction[0])
    forces = np.stack(HullExcitation(data).forces(omega, lines.U, lines.direction[0]), axis=1)
    A, damping = at_speed(*memory.coefficients(omega_e), omega_e, lines.U)
    mass = np.diag([model.parameters["m"].value, model.parameters["I5"].value])
    Z = -(omega_e**2)[:, None, None] * (mass + A) + 1j * omega_e[:, None, None] * damping + data.stiffness
    motion = np.linalg.solve(Z, forces[:, :, None])[:, :, 0]
    return motion[:, 0], motion[:, 1]


def judged(data: HullData, memory: Memory, model: Model, U: float, heading: int, sea: Spectrum) -> list[Line]:
    """One case: the band, what the constants are off inside and outside it, and what that does per wave."""
    top = 2.0 if U > 0.0 and heading > 90 else 2.6  # met within the panels' range
    beta = math.radians(heading)
    low = sea.band()[0]
    lines = realise(sea, U, beta, np.random.default_rng(0), band=(low, top))
    record = sailed(data, memory, model, lines)
    fitted = constants(model, record)
    band = frequency_range([record], ["z", "theta"])
    first, last = min(a for a, _ in band.values()), max(b for _, b in band.values())
    values = np.array([fitted.parameters[n].value for n in COEFFICIENTS])
    inside, below, above = np.linspace(first, last, 20), 0.6 * first, min(1.4 * last, 3.3)
    name = f"{U:.3g} m/s, {heading} deg, {sea.name}"
    made = [Line(f"{name}: motions show from", first, "rad/s"), Line(f"{name}: to", last, "rad/s")]
    diagonal = [0, 2, 4, 6]
    for where, omega in (("inside", inside), ("below", np.array([below])), ("above", np.array([above]))):
        true = changing(memory, omega, U)[:, diagonal]
        off = np.abs(values[diagonal] / true - 1.0)
        made.append(Line(f"{name}: a33, a55, b33, b55 off {where}, mean", 100.0 * float(np.mean(off)), "%"))
    waves = np.linspace(low, top, 60)
    met = np.abs(encounter_frequency(waves, U, beta))
    forces = np.stack(HullExcitation(data).forces(waves, U, beta), axis=1)
    found, true = operators(fitted, encounter_frequency(waves, U, beta), forces), true_operators(
        data, memory, model, waves, lines)  # fmt: skip
    within = (met >= first) & (met <= last)
    # a hull alike fore and aft does not pitch abeam
    for j, motion in enumerate(("heave", "pitch") if heading != 90 else ("heave",)):
        error = np.abs(found[j] - true[j]) / np.max(np.abs(true[j]))
        made.append(Line(f"{name}: {motion} off inside", 100.0 * float(error[within].max()), "% of max"))
        if np.any(~within):
            made.append(Line(f"{name}: {motion} off outside", 100.0 * float(error[~within].max()), "% of max"))
    return made


def run(cases: Sequence[tuple[float, int]] = CASES) -> list[Line]:
    """All cases in the paper's sea, and one in a swell."""
    data = hull()
    memory, model = memory_of(data, FINE, 30.0), ship(data)
    made = [line for U, heading in cases for line in judged(data, memory, model, U, heading, ittc(2.27))]
    return made + judged(data, memory, model, *cases[0], bretschneider(1.5, 9.0))


if __name__ == "__main__":
    print(machine())
    for line in run():
        print(f"  {line.what:<72} {line.value:>8.3g} {line.unit} {line.verdict}", flush=True)
