"""A `[[forces]]` block to force points in standard axes, SI, at the model's origin."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, ForceContent, ForcePoints, InputError, quantity, si_unit, spelling_hint
from seatrial.core.values.files import is_file
from seatrial.core.values.notation import OPPOSITE
from seatrial.core.values.record import froude_factor
from seatrial.data.read import ColumnSpec, Layout, RawTable, format_of, read_log
from seatrial.data.read.formats.text import text_layout
from seatrial.data.trial.runs import expand_variables
from seatrial.data.trial.schema import ForceColumn, ForcesTable, MotionColumn

# prime system -> symbols whose product with rho/2 U^2 makes a force; moments have one L more
PRIME_SYSTEMS = {"rho/2 L d U^2": ("L", "d"), "rho/2 L^2 U^2": ("L", "L")}
_UNITS = {"U": "m/s", "beta": "rad", "X": "N", "Y": "N", "N": "N m"}
_POSITIVE_DIRECTIONS = {"X": ("forward", "aft"), "Y": ("starboard", "port"), "N": ("starboard", "port")}
_DRIFT_SIGNS = {"bow to starboard": 1.0, "bow to port": -1.0}


def read_force_points(
    table: ForcesTable, data_folder: Path, model: Model, reference_point: float, where: str
) -> ForcePoints:
    """Read one table of force points.

    base: the folder its file is sought in. reference_point: the model's origin, m forward of midship.

    Raises:
        InputError: no such file or column, a cell that is no number, or a convention that is missing or unknown.
    """
    sheet = _read_columns(table, data_folder, where)
    length = _particular(model, "L", where)
    origin = table.origin * froude_factor("m", table.scale)
    motion_origin = origin if table.motion_origin is None else table.motion_origin * froude_factor("m", table.scale)
    for key, place in (("origin", origin), ("motion_origin", motion_origin)):
        if abs(place) > length / 2:
            raise InputError(
                f"{where}.{key} = {place:g} m lies outside the ship, {length / 2:g} m from midship to the ends; "
                "give it in m forward of midship"
            )
    motion = _motion(table, sheet, length, where)
    speed = np.hypot(motion["u"], motion["v"])
    forces, sd = _forces(table, sheet, model, speed, where)
    if "N" in forces and origin != reference_point:
        forces["N"] = _transferred_moment(forces, origin - reference_point, where)
    motion["v"] = motion["v"] + (reference_point - motion_origin) * motion["r"]
    columns = {s: str(c.column) for s, c in (*table.motion.items(), *table.measured.items()) if c.column is not None}
    return ForcePoints(sheet.file, motion, forces, sd, ForceContent(table.includes), table.source, columns)


def _read_columns(table: ForcesTable, data_folder: Path, where: str) -> RawTable:
    path = data_folder / expand_variables(table.file)
    if not is_file(path):
        raise InputError(f"{where}.file: there is no file '{path}'; check the name and [data] folder")
    wanted = {s: c for s, c in (*table.motion.items(), *table.measured.items()) if c.column is not None}
    columns = tuple(_column(symbol, column) for symbol, column in wanted.items())
    kind = format_of(path)
    layout = text_layout(path) if kind == "text" else Layout(kind, columns[0], ())
    # readers of several variables take those that share the first column's length, as they do with a record's time
    layout = replace(layout, time=columns[0], columns=columns)
    return read_log(path, layout).table_of(columns[0])


def _column(symbol: str, column: MotionColumn | ForceColumn) -> ColumnSpec:
    assert column.column is not None
    return ColumnSpec(symbol, column.column, column.unit)


def _particular(model: Model, name: str, where: str) -> float:
    if name not in model.parameters:
        raise InputError(f"{where}: model '{model.name}' has no {name}, which force points need; use mmg or abkowitz")
    return model.parameters[name].value


def _motion(table: ForcesTable, sheet: RawTable, length: float, where: str) -> dict[str, Array]:
    """u, v, r and inputs at the place they were measured, SI at the scale of the trial."""
    given = {s: _motion_values(s, c, sheet, table.scale, f"{where}.motion.{s}") for s, c in table.motion.items()}
    speed = _complete_velocity(table, given, sheet, where)
    r = given.get("r", np.zeros_like(speed))
    if "r" in table.motion and table.motion["r"].unit == "1":
        r = r * speed / length
    further = {s: values for s, values in given.items() if s not in ("U", "beta", "u", "v", "r")}
    return {"u": given["u"], "v": given["v"], "r": r, **further}


def _complete_velocity(table: ForcesTable, motion: dict[str, Array], sheet: RawTable, where: str) -> Array:
    """Complete u and v in `given` from the speed and the drift angle or v'; returns the speed, m/s."""
    if "U" in motion and np.any(motion["U"] <= 0):
        row = int(np.argmax(motion["U"] <= 0))
        raise InputError(f"{where}: the speed U in row {sheet.first_row + row} is not positive; turn the ship by beta")
    if "beta" in motion:
        _require_drift_sign(table, motion["beta"], sheet, where)
        # v = -U sin(beta), the bow to starboard of the course (Yasukawa & Yoshimura 2015, drift angle)
        beta = motion["beta"] * _DRIFT_SIGNS[str(table.motion["beta"].positive)]
        speed = motion["U"] if "U" in motion else motion["u"] / np.cos(beta)
        motion["u"], motion["v"] = speed * np.cos(beta), -speed * np.sin(beta)
    elif "v" in motion and table.motion["v"].unit == "1":
        motion["v"] = motion["v"] * motion["U"]
        motion["u"] = np.sqrt(np.maximum(motion["U"] ** 2 - motion["v"] ** 2, 0.0))
    elif "U" in motion:
        motion.setdefault("v", np.zeros_like(motion["U"]))
        motion["u"] = np.sqrt(np.maximum(motion["U"] ** 2 - motion["v"] ** 2, 0.0))
    motion.setdefault("v", np.zeros_like(motion["u"]))
    return np.hypot(motion["u"], motion["v"])


def _require_drift_sign(table: ForcesTable, beta: Array, sheet: RawTable, where: str) -> None:
    column = table.motion["beta"]
    if column.positive not in _DRIFT_SIGNS:
        raise InputError(
            f'{where}.motion.beta says nothing about its sign, and both are in use; add positive = "bow to starboard" '
            '(of the course: v = -U sin beta) or "bow to port" (v = U sin beta)'
        )
    far = np.flatnonzero(np.abs(beta) > np.pi + 1e-9)  # rad of rounding; chosen
    if far.size:
        raise InputError(
            f"{sheet.file}: row {sheet.first_row + far[0]}: the drift angle is {np.degrees(beta[far[0]]):.4g} deg, "
            f"more than half a turn; check the unit '{column.unit}' of {where}.motion.beta"
        )


def _motion_values(symbol: str, column: MotionColumn, sheet: RawTable, scale: float, where: str) -> Array:
    unit = _UNITS.get(symbol) or quantity(symbol).unit
    if column.unit == "1" and symbol in ("v", "r"):
        unit, size = "1", 1.0
    else:
        size = _unit_factor(column.unit, unit, where) * froude_factor(unit, scale)
    if column.column is None:
        assert column.value is not None
        values = np.full(len(sheet.cells[0]), column.value)
    else:
        values = sheet.numbers(_column(symbol, column))
    sign = 1.0
    if symbol not in _UNITS and column.positive is not None:
        sign = _sign(column.positive, quantity(symbol).positive, OPPOSITE[quantity(symbol).positive], where)
    return sign * size * values


def _unit_factor(unit: str, wanted: str, where: str) -> float:
    size, si = si_unit(unit)
    if si != wanted:
        raise InputError(f"{where}.unit: '{unit}' does not fit, the quantity is in {wanted}; correct it")
    return size


def _sign(positive: str, standard: str, opposite: str, where: str) -> float:
    if positive not in (standard, opposite):
        raise InputError(f"{where}.positive = '{positive}' is no direction of it; write '{standard}' or '{opposite}'")
    return 1.0 if positive == standard else -1.0


def _forces(
    table: ForcesTable, sheet: RawTable, model: Model, speed: Array, where: str
) -> tuple[dict[str, Array], dict[str, float]]:
    """Return the forces in standard axes about the file's origin, SI, and their standard deviations."""
    forces, sd = {}, {}
    for symbol, column in table.measured.items():
        place = f"{where}.measured.{symbol}"
        size = _force_scale(table, symbol, column, model, speed, place)
        sign = _sign(column.positive or _POSITIVE_DIRECTIONS[symbol][0], *_POSITIVE_DIRECTIONS[symbol], place)
        forces[symbol] = sign * size * sheet.numbers(_column(symbol, column))
        if not np.any(np.isfinite(forces[symbol])):
            raise InputError(f"{sheet.file}: column '{column.column}' ({symbol}) holds no number at all; leave it out")
        sd[symbol] = float(column.sd * np.mean(size)) if column.sd else _sd_from_range(table, forces[symbol], place)
    return forces, sd


def _sd_from_range(table: ForcesTable, force: Array, where: str) -> float:
    """The standard deviation as a share of the force's range."""
    span = float(np.nanmax(force) - np.nanmin(force))
    if table.sd_percent is None or span <= 0:
        raise InputError(f"{where} has no standard deviation; give sd in its unit, or sd_percent of the force's range")
    return table.sd_percent / 100.0 * span


def _force_scale(
    table: ForcesTable, symbol: str, column: ForceColumn, model: Model, speed: Array, where: str
) -> Array | float:
    """What a number of the file is in N or N m."""
    if not table.prime:
        if column.unit == "1":
            raise InputError(
                f'{where} is without dimension; say of which system: prime = "{next(iter(PRIME_SYSTEMS))}"'
            )
        unit = _UNITS[symbol]
        return _unit_factor(column.unit, unit, where) * froude_factor(unit, table.scale)
    if table.prime not in PRIME_SYSTEMS:
        systems = " and ".join(f'"{system}"' for system in PRIME_SYSTEMS)
        hint = spelling_hint(table.prime, list(PRIME_SYSTEMS))
        raise InputError(f"{where}: unknown prime system '{table.prime}'{hint}; known are {systems}, or give N and N m")
    if column.unit != "1":
        raise InputError(f"{where} is in '{column.unit}' although prime = \"{table.prime}\" is given; keep one")
    length, depth = (_particular(model, name, where) for name in PRIME_SYSTEMS[table.prime])
    unit = _particular(model, "rho", where) / 2 * length * depth * speed**2
    return unit * _particular(model, "L", where) if symbol == "N" else unit


def _transferred_moment(forces: dict[str, Array], lever: float, where: str) -> Array:
    """The moment about the model's origin: that about the file's, `arm` m before it, and the arm times Y."""
    if "Y" not in forces or np.any(np.isfinite(forces["N"]) & ~np.isfinite(forces["Y"])):
        raise InputError(
            f"{where}: the moment N is about a point {lever:g} m before the model's origin and cannot be moved without "
            "Y; give Y as well, or N about the origin"
        )
    return forces["N"] + lever * forces["Y"]
