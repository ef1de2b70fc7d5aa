"""Tables of a loop file into disturbances of the loop, and how waves reach what is controlled."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from seatrial.control.loopfile.plant import LoopPlant, hull_factor, yaw_acceleration_path
from seatrial.control.loopfile.schema import (
    LoopFile,
    SeawayTable,
    SlowDisturbanceTable,
    positive_value,
    symbol_unit,
)
from seatrial.control.ship import response_of_states
from seatrial.control.task import ScheduleGrid, Seaway, SlowDisturbance, TrimmedShip
from seatrial.core.values import InputError
from seatrial.data.trial.runs import excitation_of
from seatrial.data.trial.schema import ExcitationTable
from seatrial.physics.hydro.excitation import Excitation
from seatrial.physics.loops import WAVE_SLOPE, Block, HullFactor, TransferLoop, WaveEffect, YawAcceleration
from seatrial.physics.loops.encounter_spectrum import ForcedMotion, HullMotion, refuse_unknown_sea
from seatrial.physics.loops.loop import HullPoint
from seatrial.physics.sea.spectrum import Spectrum

# How the waves of a loop file reach what is controlled: by their slope, a yaw moment, or the forces on the hull.

WAVE_FORCES = ("F3", "M5")
_OUTPUT_IS_WAVES = Block("motion of the hull")
_ROUNDING = 1e-9  # share by which the speed of a sea may differ from the plant's


@dataclass(frozen=True, eq=False)
class WavePath:
    """What waves do to a loop, and how that reaches the output; see `Seaway`.

    excitation, U: of a hull whose coefficients hold at that speed [m/s]; others have none.
    """

    effect: WaveEffect
    path: Block | None = None
    at_points: tuple[WaveEffect, ...] = ()
    excitation: Excitation | None = None
    U: float = 0.0

    def seaway(self, spectrum: Spectrum, U: float, beta: float, spreading: float | None, where: str) -> Seaway:
        """Return a sea that reaches the loop so; `where`: its key, for messages."""
        if self.excitation is not None:
            if abs(U - self.U) > _ROUNDING * self.U:
                raise InputError(
                    f"{where}.speed: the coefficients of heave and pitch hold at {self.U:.4g} m/s, not at {U:.4g} m/s; "
                    "leave the speed out, or identify a model there"
                )
            try:
                refuse_unknown_sea(self.excitation, spectrum)
            except InputError as error:
                raise InputError(f"{where}: {error}") from None
        return Seaway(spectrum, U, beta, self.effect, spreading, self.path, self.at_points)


def meets_wave_forces(plant: LoopPlant) -> bool:
    """Return whether waves reach the plant by forces on the hull."""
    return plant.trimmed_ship is not None and set(WAVE_FORCES) <= set(plant.trimmed_ship.model.input_names)


def point_motions(plant: LoopPlant, places: tuple[float, ...]) -> tuple[HullPoint, ...]:
    """Return what the actuator does to the hull at places [m forward of the origin].

    Raises:
        InputError: the plant is no model of heave and pitch.
    """
    if not places:
        return ()
    ship = plant.trimmed_ship
    if ship is None or not meets_wave_forces(plant):
        raise InputError("minimise: 'x' goes with a model of heave and pitch (plant.model); leave it out")
    return tuple(HullPoint(x, _response(ship, plant.actuator, 1.0, -x)) for x in places)


def wave_path(
    plant: LoopPlant, hull: HullFactor | None, excitation: ExcitationTable | None, home: Path, places: tuple[float, ...]
) -> WavePath:
    """Return how waves reach the plant: roll by slope, heave and pitch by their forces, heading by a yaw moment.

    home: folder of the loop file, from which the excitation's file counts; places: of `point_motions`.

    Raises:
        InputError: waves do not reach the output, or what they need is missing.
    """
    if plant.disturbed_by == "alpha_w":
        return WavePath(hull or WAVE_SLOPE)
    if plant.trimmed_ship is not None and meets_wave_forces(plant):
        return _hull_path(plant, plant.trimmed_ship, excitation, home, places)
    if plant.output != "psi":
        raise InputError(
            f"seas: waves reach roll, heading, and heave and pitch of an identified model, not '{plant.output}' here; "
            "describe what disturbs it under [[slow_disturbances]]"
        )
    if hull is None:
        raise InputError("seas: the yaw moment of waves needs the hull; add [hull] with L, B and T in m")
    return WavePath(YawAcceleration(hull.L, hull.T), yaw_acceleration_path(plant))


def _hull_path(
    plant: LoopPlant, ship: TrimmedShip, table: ExcitationTable | None, home: Path, places: tuple[float, ...]
) -> WavePath:
    weights = {"z": (1.0, 0.0), "theta": (0.0, 1.0)}
    if plant.output not in weights:
        raise InputError(f'seas: give plant.output = "theta" or "z", not \'{plant.output}\'')
    if table is None or plant.ship is None:
        raise InputError(
            f"seas: waves move model '{ship.model.name}' by the forces F3 and M5; add [excitation] with source = "
            '"box", or a file of forces with source = "table" or "capytaine"'
        )
    excitation = excitation_of(table, plant.ship, ship.model, home)
    assert excitation is not None
    heave, pitch = (
        ForcedMotion(*(_response(ship, force, *weights[motion]) for force in WAVE_FORCES)) for motion in ("z", "theta")
    )
    effect = HullMotion(excitation, heave, pitch, *weights[plant.output])
    there = tuple(replace(effect, heave=1.0, pitch=-x) for x in places)
    return WavePath(effect, _OUTPUT_IS_WAVES, there, excitation, plant.U)


def _response(ship: TrimmedShip, name: str, heave: float, pitch: float) -> Block:
    """Return the transfer function from an input to so much of heave and pitch."""
    return response_of_states(ship, name, {"z": heave, "theta": pitch})


# Tables of a loop file into disturbances of the loop: seas under a heading, slow ones, conditions of a schedule.


def loop_disturbances(
    file: LoopFile, plant: LoopPlant, home: Path, places: tuple[float, ...]
) -> tuple[Seaway | SlowDisturbance, ...]:
    """Return everything that disturbs the loop, in the order of the file.

    home: folder of the file; places: m forward of the origin, of the loop's points.
    """
    if not file.seas and not file.slow_disturbances:
        raise InputError(
            "nothing disturbs the loop: add a block [[seas]], or [[slow_disturbances]] for what acts like the actuator"
        )
    seas: tuple[Seaway, ...] = ()
    if file.seas:
        path = wave_path(plant, hull_factor(file.hull, plant.ship), file.excitation, home, places)
        seas = tuple(seaway(table, plant.U, path, f"seas[{i}]") for i, table in enumerate(file.seas, start=1))
    slow = (
        _slow_disturbance(table, plant, f"slow_disturbances[{i}]")
        for i, table in enumerate(file.slow_disturbances, start=1)
    )
    return (*seas, *slow)


def refuse_calm(
    disturbances: tuple[Seaway | SlowDisturbance, ...], loop: TransferLoop, grid: ScheduleGrid | None
) -> None:
    """Refuse seas, and headings of a schedule, that do not reach the loop."""
    for i, one in enumerate((m for m in disturbances if isinstance(m, Seaway)), start=1):
        try:
            one.exposure(loop)
        except InputError as error:
            raise InputError(f"seas[{i}]: {error}") from None
    seas = [m for m in disturbances if isinstance(m, Seaway)]
    if grid is not None and not seas:
        raise InputError(
            "schedule: there is no block [[seas]] to give its spectrum; add one, or leave the schedule out"
        )
    is_met = len(seas) < len(disturbances)  # something acts on a heading that no sea reaches
    for beta in () if grid is None or is_met else grid.headings:
        try:
            replace(seas[0], beta=beta).exposure(loop)
        except InputError as error:
            raise InputError(f"schedule.headings: {error}") from None
    _refuse_other_speeds(seas, grid)


def _refuse_other_speeds(seas: Sequence[Seaway], grid: ScheduleGrid | None) -> None:
    """Refuse a schedule over speeds at which the motions of the hull in waves are not known."""
    if grid is None or not seas[0].is_output:
        return
    if not np.allclose(grid.speeds, seas[0].U):
        raise InputError(
            f"schedule.speeds: the coefficients of heave and pitch hold at {seas[0].U:.4g} m/s; give this speed alone"
        )


def seaway(table: SeawayTable, U: float, path: WavePath, where: str) -> Seaway:
    """Return one sea; at the plant's speed U [m/s] where it names none."""
    speed = U if table.speed is None else table.speed
    return path.seaway(table.to_spectrum(where), speed, table.heading, table.spreading, where)


def _slow_disturbance(table: SlowDisturbanceTable, plant: LoopPlant, where: str) -> SlowDisturbance:
    return SlowDisturbance(
        positive_value(table.rms, symbol_unit(plant.disturbed_by), f"{where}.rms"),
        table.bandwidth,
        plant.U if table.speed is None else table.speed,
        symbol_unit(plant.disturbed_by),
        "of the actuator" if plant.disturbed_by == plant.actuator else f"of {plant.disturbed_by}",
    )
