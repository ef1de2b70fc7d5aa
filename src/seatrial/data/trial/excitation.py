"""`[excitation]` and `[records.waves]` of a trial file: wave forces, and how the ship meets the waves."""

import math
from pathlib import Path

from seatrial.core.equations import Model
from seatrial.core.values import InputError, Ship
from seatrial.data.trial.schema import ExcitationTable, WavesTable
from seatrial.physics.hydro.dispersion import G
from seatrial.physics.hydro.excitation import BoxHull, Excitation
from seatrial.physics.sea.encounter import WaveEncounter, speed_factor

# Froude number beyond which the speed is taken for one in knots, ours
_MAX_FROUDE = 1.0
_BOX_DIMENSIONS = ("L", "B", "d", "c33", "c35", "c53", "c55")


def excitation_of(table: ExcitationTable | None, ship: Ship, model: Model, data_folder: Path) -> Excitation | None:
    """The excitation that the table names; files lie under `base`.

    Raises:
        InputError: a model that knows no wave force, a dimension of the box that nobody gives, or a file that cannot be
            read.
    """
    if table is None:
        return None
    if not {"F3", "M5"} <= set(model.input_names):
        raise InputError(f"[excitation]: model '{model.name}' has no inputs F3 and M5; remove the table")
    if table.source == "table":
        from seatrial.physics.hydro.transfer_file import read_transfer

        return read_transfer(data_folder / str(table.file))
    if table.source == "capytaine":
        from seatrial.physics.hydro.capytaine_data import HullExcitation, read_capytaine

        return HullExcitation(read_capytaine(data_folder / str(table.file)))
    return _box_excitation(ship, model)


def _box_excitation(ship: Ship, model: Model) -> BoxHull:
    values = {p.name: p.value for p in model.parameters} | dict(ship.particulars)
    for name in _BOX_DIMENSIONS:
        if name not in values:
            raise InputError(f"[excitation] source = 'box' needs ship.{name}; add it")
    L, B, T, c33, c35, c53, c55 = (values[name] for name in _BOX_DIMENSIONS)
    return BoxHull(L, B, T, c33, c35, c53, c55)


def wave_encounter(
    table: WavesTable | None, excitation: Excitation | None, length: float, where: str
) -> WaveEncounter | None:
    """How a block's runs met the waves; None for records that carry their wave forces themselves. length: m.

    Raises:
        InputError: waves without an excitation, or a speed or heading out of sense.
    """
    if table is None:
        return None
    froude = table.speed / math.sqrt(G * length)
    if froude > _MAX_FROUDE:
        raise InputError(
            f"{where}.waves: {table.speed:.3g} m/s is a Froude number of {froude:.2g} at L = {length:g} m, where "
            "no strip theory holds; is the speed in knots?"
        )
    if excitation is None:
        raise InputError(f"{where}.waves: nothing turns the elevation into forces; add [excitation] source = 'box'")
    try:
        speed_factor(table.speed, table.heading)
    except InputError as error:
        raise InputError(f"{where}.waves: {error}") from None
    spectrum = None if table.sea is None else table.sea.to_spectrum(f"{where}.waves.sea")
    return WaveEncounter(excitation, table.speed, table.heading, spectrum)
