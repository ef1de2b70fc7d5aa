"""Tables of a loop file into disturbances of the loop: seas under a heading, slow ones, conditions of a schedule."""

import math

from seatrial.control.loopfile.plant import LoopPlant, yaw_acceleration_path
from seatrial.control.loopfile.quantities import heading_value, positive_value, symbol_unit
from seatrial.control.loopfile.schema import LoopFile, ScheduleTable, SeawayTable, SlowDisturbanceTable
from seatrial.control.task import ScheduleGrid, Seaway, SlowDisturbance
from seatrial.core.values import InputError
from seatrial.physics.loops import WAVE_SLOPE, Block, HullFactor, TransferLoop, WaveEffect, YawAcceleration

_NO_SLOPE = 1e-6  # |sin(heading)| below which long-crested waves have no slope across the ship: rounding


def loop_disturbances(
    file: LoopFile, plant: LoopPlant, hull: HullFactor | None
) -> tuple[Seaway | SlowDisturbance, ...]:
    """Return everything that disturbs the loop, in the order of the file."""
    if not file.seas and not file.slow_disturbances:
        raise InputError(
            "nothing disturbs the loop: add a block [[seas]], or [[slow_disturbances]] for what acts like the actuator"
        )
    effect, path = _wave_effect(plant, hull) if file.seas else (WAVE_SLOPE, None)
    seas = (seaway(table, plant.U, effect, path, f"seas[{i}]") for i, table in enumerate(file.seas, start=1))
    slow = (
        _slow_disturbance(table, plant, f"slow_disturbances[{i}]")
        for i, table in enumerate(file.slow_disturbances, start=1)
    )
    return (*seas, *slow)


def _wave_effect(plant: LoopPlant, hull: HullFactor | None) -> tuple[WaveEffect, Block | None]:
    """Return what waves do to the loop and its path to the output: their slope to roll, their yaw moment to heading."""
    if plant.disturbed_by == "alpha_w":
        return hull or WAVE_SLOPE, None
    if plant.output != "psi":
        raise InputError(
            f"seas: a sea acts on roll or heading, not on '{plant.output}'; describe what disturbs it under "
            "[[slow_disturbances]]"
        )
    if hull is None:
        raise InputError("seas: the yaw moment of waves needs the hull; add [hull] with L, B and T in m")
    return YawAcceleration(hull.L, hull.T), yaw_acceleration_path(plant)


def refuse_calm(
    disturbances: tuple[Seaway | SlowDisturbance, ...], loop: TransferLoop, grid: ScheduleGrid | None
) -> None:
    """Refuse seas, and headings of a schedule, that have no slope across the ship."""
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
    if grid is not None and seas[0].spreading is None:
        for beta in grid.headings:
            if abs(math.sin(beta)) < _NO_SLOPE:
                raise InputError(
                    f"schedule.headings: long-crested waves at {math.degrees(beta):.0f} deg have no slope across the "
                    "ship; leave the heading out, or give the first sea a spreading"
                )


def seaway(table: SeawayTable, U: float, effect: WaveEffect, path: Block | None, where: str) -> Seaway:
    """Return one sea; at the plant's speed U [m/s] where it names none."""
    speed = U if table.speed is None else positive_value(table.speed, "m/s", f"{where}.speed")
    beta = heading_value(table.heading, f"{where}.heading")
    return Seaway(table.to_spectrum(where), speed, beta, effect, table.spreading, path)


def schedule_grid(table: ScheduleTable) -> ScheduleGrid:
    """Return the conditions of a schedule."""
    return ScheduleGrid(
        tuple(positive_value(a, "m/s", "schedule.speeds") for a in table.speeds.quantities()),
        tuple(heading_value(a, "schedule.headings") for a in table.headings.quantities()),
        tuple(positive_value(a, "m", "schedule.heights") for a in table.heights.quantities()),
        table.largest_step,
    )


def _slow_disturbance(table: SlowDisturbanceTable, plant: LoopPlant, where: str) -> SlowDisturbance:
    return SlowDisturbance(
        positive_value(table.rms, symbol_unit(plant.disturbed_by), f"{where}.size"),
        positive_value(table.bandwidth, "rad/s", f"{where}.bandwidth"),
        plant.U if table.speed is None else positive_value(table.speed, "m/s", f"{where}.speed"),
        symbol_unit(plant.disturbed_by),
        "of the actuator" if plant.disturbed_by == plant.actuator else f"of {plant.disturbed_by}",
    )
