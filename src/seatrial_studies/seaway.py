"""The ship of Qi et al. 2025 and Meng et al. 2014 in a known sea: records whose truth is continuous."""

import math
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, Channel, InputError, Provenance, Record, RecordKind, frozen
from seatrial.data.example_series import write_csv
from seatrial.physics.hydro import BoxHull
from seatrial.physics.models import PARAMETER_SETS, ParameterSet, heave_pitch, parameter_set
from seatrial.physics.sea import DEFAULT_COMPONENTS, Spacing, WaveComponents, harmonic_sum, ittc, realise
from seatrial.physics.simulate import LinearBatch, harmonic_motion, linear_system

# The ship of Qi et al. 2025 and Meng et al. 2014: its speed, sea and coefficients at the headings of the tables.

_SET_PREFIX = "qi2025-"
SPEED = 18.0 * 1852.0 / 3600.0
"""Speed of the ship, m/s: 18 kn (Qi et al. 2025, section 4)."""
SIGNIFICANT_HEIGHT = 2.27
"""Significant height of the sea, m (Qi et al. 2025, section 4)."""
HEADINGS = tuple(int(name.removeprefix(_SET_PREFIX)) for name in PARAMETER_SETS if name.startswith(_SET_PREFIX))
"""Headings to the waves of tables 2 to 4, degrees; 180 is head sea."""
SHIP = parameter_set(f"{_SET_PREFIX}{HEADINGS[0]}").ship


def theoretical_coefficients(heading: int, *, printed_sign: bool = False) -> ParameterSet:
    """Return the theoretical coefficients at a heading of the tables; b53 negative unless `printed_sign`.

    Args:
        heading: degrees.
        printed_sign: take b53 positive, as the tables print it.

    Raises:
        InputError: the paper gives none at this heading.
    """
    if heading not in HEADINGS:
        raise InputError(f"Qi et al. 2025 give no theoretical values at {heading} degrees; known are 90, 135, 180")
    published = parameter_set(f"{_SET_PREFIX}{heading}")
    if not printed_sign:
        return published
    values = {**published.values, "b53": -published.values["b53"]}
    return replace(published, values=values, note="b53 positive as printed")


# A ship of known coefficients in a known sea: records whose truth is continuous, not the fitted discretisation.

# assumed, printed nowhere: lift slope rho/2 U^2 A C_L_alpha with 6 m^2 and 3/rad, 25 m aft, +-10 degrees for 1 s each
FIN = {"lift_1": 0.5 * 1025.0 * SPEED**2 * 6.0 * 3.0, "x_f1": -25.0}
FIN_ANGLE, FIN_HOLD = math.radians(10.0), 1.0
HEAVE_NOISE, PITCH_NOISE = 0.01, math.radians(0.02)


def box_hull() -> BoxHull:
    """Return the paper's ship as a box: its force coefficients are not printed."""
    p = SHIP.particulars
    return BoxHull(p["L"], p["B"], p["d"], p["c33"], p["c35"], p["c53"], p["c55"])


@dataclass(frozen=True)
class SeawayScenario:
    """The simulated scenario: heading in degrees, significant height [m], duration and time step [s], fin, sensors.

    Attributes:
        motion_stride: only each `motion_stride`-th sample of the motions is measured.
        noise: standard deviations of heave [m] and pitch [rad].
    """

    heading: int
    height: float = SIGNIFICANT_HEIGHT
    duration: float = 200.0
    dt: float = 0.1
    motion_stride: int = 1
    has_waves: bool = True
    has_fin: bool = True
    noise: tuple[float, float] = (HEAVE_NOISE, PITCH_NOISE)
    spacing: Spacing = Spacing.EQUAL_INTERVAL
    line_count: int = DEFAULT_COMPONENTS


@dataclass(frozen=True, eq=False)
class SeawayRun:
    """A record, the ship that was simulated, and the lines of the sea it met."""

    record: Record
    truth: Model
    lines: WaveComponents

    def with_sensor_noise(self, rng: np.random.Generator, scenario: SeawayScenario) -> Record:
        """Return the record with a draw of sensor noise."""
        own = self.record.channels
        made = {
            name: own[name].with_values(own[name].values + sd * rng.standard_normal(len(self.record)))
            for name, sd in zip(("z", "theta"), scenario.noise, strict=True)
        }
        return Record(self.record.name, self.record.time, {**own, **made}, RecordKind.SIMULATED, self.record.provenance)


def ship(heading: int) -> Model:
    """Return the paper's ship at a heading of its tables, with the assumed fin."""
    return theoretical_coefficients(heading).applied_to(heave_pitch()).with_values(FIN)


def simulate_seaway_run(scenario: SeawayScenario, rng: np.random.Generator, truth: Model | None = None) -> SeawayRun:
    """Return the voyage without sensor noise; `rng` draws the sea's phases and the fin's commands.

    Raises:
        InputError: no coefficients at this heading, or a sea that cannot be made.
    """
    model = truth or ship(scenario.heading)
    count = round(scenario.duration / scenario.dt) + 1
    time = np.arange(count, dtype=np.float64) * scenario.dt
    beta = math.radians(scenario.heading)
    lines = realise(ittc(scenario.height), SPEED, beta, rng, count=scenario.line_count, spacing=scenario.spacing)
    amplitude = -lines.forces(box_hull()) * float(scenario.has_waves)  # z down, theta bow up
    angle = -fin_commands(count, scenario.dt, rng) * float(scenario.has_fin)
    inputs = np.zeros((count, 4))
    inputs[:, 2] = angle
    forces = np.zeros((len(lines.omega), 4), complex)
    forces[:, :2] = amplitude
    motion = harmonic_motion(linear_system(model, ("z", "theta")), lines.omega_e, forces, time, np.zeros(4))
    batch = LinearBatch(model, inputs, np.array([0, count]), scenario.dt, ("z", "theta"))
    motion = motion + batch.simulate(0, 1, np.zeros((1, 4)), model.parameters.values[None], np.empty((1, 0)))[0]
    motion[np.arange(count) % scenario.motion_stride != 0] = np.nan
    waves = [harmonic_sum(lines.omega_e, -amplitude[:, j], time) for j in (0, 1)]
    channels = {"zeta": lines.elevation(time), "F3": waves[0], "M5": waves[1], "delta_f1": -angle,
                "z": motion[:, 0], "theta": motion[:, 1]}  # fmt: skip
    made = {name: Channel.from_notation(name, frozen(values)) for name, values in channels.items()}
    name = f"{scenario.heading} deg"
    return SeawayRun(Record(name, frozen(time), made, RecordKind.SIMULATED, Provenance("simulated sea")), model, lines)


def fin_commands(count: int, dt: float, rng: np.random.Generator) -> Array:
    """Fin angles lifting up [rad]: a random binary sequence."""
    hold = max(1, round(FIN_HOLD / dt))
    return FIN_ANGLE * np.repeat(rng.choice([-1.0, 1.0], count // hold + 1), hold)[:count]


MOTIONS = ("delta_f1", "z", "theta")
_WAVES_RECORDED = SeawayScenario(135, duration=150.0)
_WAVES_UNRECORDED = SeawayScenario(135, dt=0.2, duration=400.0, spacing=Spacing.JITTERED, line_count=300)
# file -> voyage and what was recorded of the waves: their elevation, nothing, or the force
EXAMPLES = {
    "voyage_1": (_WAVES_RECORDED, ("zeta",)),
    "voyage_2": (_WAVES_RECORDED, ("zeta",)),
    "voyage_held_out": (_WAVES_RECORDED, ("zeta",)),
    "sea_unrecorded": (_WAVES_UNRECORDED, ()),
    "forces_recorded": (_WAVES_RECORDED, ("F3", "M5")),
}


def main(folder: str) -> None:
    """Write the example voyages to `folder`."""
    for number, (name, (voyage, waves)) in enumerate(EXAMPLES.items()):
        record = simulate_seaway_run(voyage, np.random.default_rng([2025, number])).with_sensor_noise(
            np.random.default_rng([7, number]), voyage
        )
        path = Path(folder) / f"{name}.csv"
        write_csv(record, path, (*waves, *MOTIONS))
        print(f"{path}: {record.duration:.0f} s, {path.stat().st_size / 1000:.0f} kB")


if __name__ == "__main__":
    import sys

    if len(sys.argv) != 2:
        sys.exit("usage: python -m seatrial_studies.seaway FOLDER")
    main(sys.argv[1])
