"""Tables of a loop file into disturbances of the loop: seas under a heading, slow ones, conditions of a schedule."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np

from seatrial.control.loopfile.plant import LoopPlant, hull_factor
from seatrial.control.loopfile.quantities import heading_value, positive_value, symbol_unit
from seatrial.control.loopfile.schema import LoopFile, ScheduleTable, SeawayTable, SlowDisturbanceTable
from seatrial.control.loopfile.wave_paths import WavePath, wave_path
from seatrial.control.task import ScheduleGrid, Seaway, SlowDisturbance
from seatrial.core.values import InputError
from seatrial.physics.loops import TransferLoop


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
    speed = U if table.speed is None else positive_value(table.speed, "m/s", f"{where}.speed")
    beta = heading_value(table.heading, f"{where}.heading")
    return path.seaway(table.to_spectrum(where), speed, beta, table.spreading, where)


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
        positive_value(table.rms, symbol_unit(plant.disturbed_by), f"{where}.rms"),
        positive_value(table.bandwidth, "rad/s", f"{where}.bandwidth"),
        plant.U if table.speed is None else positive_value(table.speed, "m/s", f"{where}.speed"),
        symbol_unit(plant.disturbed_by),
        "of the actuator" if plant.disturbed_by == plant.actuator else f"of {plant.disturbed_by}",
    )
