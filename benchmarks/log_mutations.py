"""What `seatrial init` makes of real and simulated logs whose columns were rewritten: right, assumed, open, wrong.

    python benchmarks/log_mutations.py [--seed 1] [--count 60] [--logs NAME ...] [--table]

Each log is rewritten by one to three kinds of mutation, as people and loggers write them: other units, signs, axes and
zeros, headings without units or in another language, order and separators, coarse numbers. A channel counts as right
with its column, unit, frame, side and zero; as open where the draft asks; as assumed where it is wrong and marked so;
as silent where it is wrong without a word. SEATRIAL_DATA is the folder of the records; examples come with the package.
"""

import argparse
import os
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd

sys.path.insert(0, str(Path(__file__).parents[1]))

from seatrial.api import draft_trial
from seatrial.core.values import InputError
from seatrial.data.draft import ColumnGuess

REPOSITORY = Path(__file__).parents[1]
SILENT, RIGHT_OR_OPEN, OPEN = 0.005, 0.97, 0.15  # shares of the channels: targets
TURN, KNOT = 360.0, 1852.0 / 3600.0  # deg; m/s
_SAME_ZERO = 0.01  # of a turn, by which zeros may differ; chosen


@dataclass(frozen=True)
class Truth:
    """What a column is: the symbol, unit, frame and positive side, and what is added to it [its unit]."""

    symbol: str
    unit: str
    frame: str = ""
    positive: str = ""
    offset: float = 0.0


@dataclass(frozen=True)
class Table:
    """A log as a table: its cells, what each column is, the heading without its unit, and how it is written."""

    cells: pd.DataFrame
    truth: dict[str, Truth]
    separator: str = ","
    decimal: str = "."
    notes: tuple[str, ...] = ()

    def column(self, symbol: str) -> str | None:
        """The column of a channel; None where there is none."""
        return next((name for name, one in self.truth.items() if one.symbol == symbol), None)

    def with_values(self, name: str, values: np.ndarray, truth: Truth) -> "Table":
        """Return the table with another column of the same name."""
        return replace(self, cells=self.cells.assign(**{name: values}), truth={**self.truth, name: truth})

    def renamed(self, names: dict[str, str]) -> "Table":
        """Return the table with other headings."""
        truth = {names.get(name, name): one for name, one in self.truth.items()}
        return replace(self, cells=self.cells.rename(columns=names), truth=truth)


def _truth(text: str) -> dict[str, Truth]:
    rows = (row.split("|") for row in text.split("; "))
    return {row[0]: Truth(*row[1:]) for row in rows}


_SHIP = "Latitude|lat|deg; Longitude|lon|deg; Heading [deg]|psi|deg; ROT [deg/min]|r|deg/min; "\
        "Speed fwd [kn]|u|kn|body; Speed stbd [kn]|v|kn|body; Rudder [deg]|delta|deg; Shaft [rpm]|n|rpm"  # fmt: skip
_USV = "x_ned|x0|m; y_ned|y0|m; yaw|psi|deg; surge|u|m/s|body; sway|v|m/s|body; yaw_rate|r|rad/s"
_ESSO = "x_position_mid [m]|x0|m; y_position_mid [m]|y0|m; u_velo [m/s]|u|m/s|body; "\
        "vm_velo [m/s]|v|m/s|body; psi_hat [rad]|psi|rad; r_angvelo [rad/s]|r|rad/s; n_prop [rps]|n|rps; "\
        "delta_rudder [rad]|delta|rad"  # fmt: skip
LOGS = {
    "examples/ship/zigzag_20_20.csv": _SHIP,
    "examples/ship/circle_35_port.csv": _SHIP,
    "examples/usv/afternoon_1.csv": _USV,
    "esso_osaka/zigzag/zigzag_31-Jul-2020_13_22_52.csv": _ESSO,
    "kvlcc2_rolldecay/model_test_21337.csv": "x|x0|m; y|y0|m; phi|phi|rad; theta|theta|rad; psi|psi|rad",
    "blueboat/fixed_00000226.csv": _USV,
    "repro/logs/slow_gps_in_a_fast_table/held.csv":
        "lat|lat|deg; lon|lon|deg; heading [deg]|psi|deg; rudder [deg]|delta|deg",
    "repro/logs/speed_through_water_in_a_tide/tide1.csv":
        "lat|lat|deg; lon|lon|deg; heading [deg]|psi|deg; yaw rate [deg/s]|r|deg/s; rudder [deg]|delta|deg",
    "repro/logs/circle_by_whole_degrees/circle.csv":
        "x0|x0|m; y0|y0|m; heading|psi|deg; yaw_rate|r|deg/s; rudder|delta|deg||port",
    "repro/logs/short_light_decay/short.csv": "roll|phi|deg",
}  # fmt: skip

Mutation = Callable[[Table, np.random.Generator], Table | None]
_UNITS = {"deg": ("rad", np.pi / 180.0), "rad": ("deg", 180.0 / np.pi), "kn": ("m/s", KNOT),
          "m/s": ("kn", 1.0 / KNOT), "deg/s": ("deg/min", 60.0), "deg/min": ("rad/s", np.pi / 10800.0),
          "rad/s": ("deg/s", 180.0 / np.pi)}  # fmt: skip
_SIDES = {"delta": "port", "r": "port", "v": "port", "phi": "port", "psi": "port", "y0": "west"}
_LANGUAGES = {
    "norwegian": {"psi": "Stevning", "delta": "Rorvinkel", "r": "Svinghastighet", "lat": "Breddegrad",
                  "lon": "Lengdegrad", "phi": "Krengning", "n": "Propellerturtall"},
    "german": {"psi": "Steuerkurs", "delta": "Ruderlage", "r": "Drehrate", "lat": "Breite", "lon": "Laenge",
               "phi": "Rollwinkel", "n": "Wellendrehzahl"},
    "spanish": {"psi": "Rumbo", "delta": "Timon", "r": "Velocidad de giro", "lat": "Latitud", "lon": "Longitud",
                "phi": "Balanceo", "n": "Revoluciones"},
}  # fmt: skip
_PLAIN = {"psi": "heading", "delta": "rudder", "r": "yaw rate", "u": "surge", "v": "sway", "n": "shaft rpm",
          "phi": "roll", "theta": "pitch", "lat": "lat", "lon": "lon", "x0": "x", "y0": "y", "z": "heave"}  # fmt: skip


def _factor(table: Table, symbol: str, unit: str, factor: float) -> Table:
    name = table.column(symbol)
    assert name is not None
    old = table.truth[name]
    new = replace(old, unit=unit, offset=old.offset * factor)
    changed = table.with_values(name, table.cells[name].to_numpy(float) * factor, new)
    return changed.renamed({name: _PLAIN.get(symbol, symbol)})


def other_units(table: Table, generator: np.random.Generator, *, is_said: bool = False) -> Table | None:
    """Angles, rates or speeds in another unit, which the headings say or do not say."""
    kind = generator.choice(["psi phi theta delta", "r", "u v", "psi phi theta delta r"])
    for symbol in kind.split():
        name = table.column(symbol)
        if name is not None:
            unit, factor = _UNITS[table.truth[name].unit]
            table = _factor(table, symbol, unit, factor)
            plain = table.column(symbol)
            table = table.renamed({plain: f"{plain} [{unit}]"}) if is_said else table
    return table


def without_units(table: Table, _: np.random.Generator) -> Table:
    """Headings of plain names, without units."""
    return table.renamed({name: _PLAIN.get(one.symbol, one.symbol) for name, one in table.truth.items()})


def reversed_side(table: Table, generator: np.random.Generator) -> Table | None:
    """A column that counts to the other side."""
    there = [s for s in _SIDES if (name := table.column(s)) and table.truth[name].frame != "enu"]
    symbol = str(generator.choice(there))
    name = table.column(symbol)
    assert name is not None
    old = table.truth[name]
    positive = "" if old.positive else _SIDES[symbol]
    return table.with_values(name, -table.cells[name].to_numpy(float), replace(old, positive=positive))


def heading_from_east(table: Table, _: np.random.Generator) -> Table | None:
    """A heading that counts from east, counter-clockwise, and a yaw rate with it."""
    name = table.column("psi")
    if name is None:
        return None
    turn = _full_turn(table.truth[name])
    values = np.mod(0.25 * turn - table.cells[name].to_numpy(float), turn)
    return table.with_values(name, values, Truth("psi", table.truth[name].unit, "enu"))


def axes_exchanged(table: Table, _: np.random.Generator) -> Table | None:
    """Positions with x to the east, as mathematicians have them."""
    x, y = table.column("x0"), table.column("y0")
    if x is None or y is None:
        return None
    north, east = table.cells[x].to_numpy(float), table.cells[y].to_numpy(float)
    table = table.with_values(x, east, Truth("x0", "m", "enu")).with_values(y, north, Truth("y0", "m", "enu"))
    return table.renamed({x: "x", y: "y"})


def velocities_over_ground(table: Table, _: np.random.Generator) -> Table | None:
    """Velocities to north and east, called u and v."""
    names = [table.column(symbol) for symbol in ("u", "v", "psi")]
    if None in names:
        return None
    u, v, psi = (table.cells[name].to_numpy(float) for name in names)
    psi = np.radians(psi) if table.truth[str(names[2])].unit == "deg" else psi
    unit = table.truth[str(names[0])].unit
    table = table.with_values(str(names[0]), u * np.cos(psi) - v * np.sin(psi), Truth("u", unit, "earth"))
    table = table.with_values(str(names[1]), u * np.sin(psi) + v * np.cos(psi), Truth("v", unit, "earth"))
    return table.renamed({str(names[0]): f"u [{unit}]", str(names[1]): f"v [{unit}]"})


def wrapped_elsewhere(table: Table, _: np.random.Generator) -> Table | None:
    """Headings from -180 to 180, roll from 0 to 360."""
    for symbol in ("psi", "phi"):
        name = table.column(symbol)
        if name is not None:
            one = table.truth[name]
            turn = _full_turn(one)
            values = table.cells[name].to_numpy(float)
            half = 0.5 * turn if symbol == "psi" else 0.0
            table = table.with_values(name, np.mod(values + half, turn) - half, one)
    return table


def upside_down(table: Table, _: np.random.Generator) -> Table | None:
    """Roll of a sensor that hangs upside down, from -180 to 180."""
    return _turned(table, "phi", 0.5, lowest=-0.5)


def heading_across(table: Table, generator: np.random.Generator) -> Table | None:
    """A compass that is a quarter or half of a turn off."""
    return _turned(table, "psi", float(generator.choice([0.25, -0.25, 0.5])))


def _turned(table: Table, symbol: str, share: float, lowest: float = 0.0) -> Table | None:
    """An angle that a share of a turn is added to, from a lowest value on, which is one too."""
    name = table.column(symbol)
    if name is None:
        return None
    truth = table.truth[name]
    turn = _full_turn(truth)
    values = np.mod(table.cells[name].to_numpy(float) + (share - lowest) * turn, turn) + lowest * turn
    return table.with_values(name, values, replace(truth, offset=-share * turn))


def _full_turn(truth: Truth) -> float:
    """A full turn in the unit of an angle."""
    return TURN if truth.unit == "deg" else 2.0 * np.pi


def whole_numbers(table: Table, _: np.random.Generator) -> Table:
    """Angles in whole degrees, speeds in tenths."""
    for name, one in table.truth.items():
        if one.unit in ("deg", "kn"):
            digits = 0 if one.unit == "deg" and one.symbol not in ("lat", "lon") else 1
            if one.symbol not in ("lat", "lon"):
                table = table.with_values(name, np.round(table.cells[name].to_numpy(float), digits), one)
    return table


def scaled_numbers(table: Table, _: np.random.Generator) -> Table | None:
    """Fixes in 1e-7 deg and headings in 1/100 deg, as MAVLink has them."""
    if table.column("lat") is None:
        return None
    for symbol, factor in (("lat", 1e7), ("lon", 1e7), ("psi", 1e2)):
        name = table.column(symbol)
        if name is not None and table.truth[name].unit == "deg":
            values = np.round(table.cells[name].to_numpy(float) * factor)
            table = table.with_values(name, values, table.truth[name]).renamed({name: _PLAIN[symbol]})
    return table


def wrong_header(table: Table, generator: np.random.Generator) -> Table | None:
    """A heading or yaw rate in another unit than its heading says, where a track shows it."""
    there = [s for s in ("psi", "r") if table.column(s) and table.truth[str(table.column(s))].unit in _UNITS]
    if not there or not (table.column("lat") or table.column("u")):
        return None
    symbol = str(generator.choice(there))
    name = str(table.column(symbol))
    old = table.truth[name].unit
    unit, factor = _UNITS[old]
    return _factor(table, symbol, unit, factor).renamed({_PLAIN[symbol]: f"{_PLAIN[symbol]} [{old}]"})


def other_language(table: Table, generator: np.random.Generator) -> Table:
    """Headings in another language."""
    words = _LANGUAGES[str(generator.choice(list(_LANGUAGES)))]
    names = {name: words[one.symbol] for name, one in table.truth.items() if one.symbol in words}
    return table.renamed({name: f"{word} [{table.truth[name].unit}]" for name, word in names.items()})


def shuffled(table: Table, generator: np.random.Generator) -> Table:
    """Columns in another order, with one of numbers that mean nothing."""
    rest = list(table.cells.columns[1:])
    generator.shuffle(rest)
    cells = table.cells[[table.cells.columns[0], *rest]].assign(status=generator.integers(0, 3, len(table.cells)))
    return replace(table, cells=cells)


def decimal_commas(table: Table, _: np.random.Generator) -> Table:
    """Semicolons and decimal commas."""
    return replace(table, separator=";", decimal=",")


def thinned(table: Table, _: np.random.Generator) -> Table:
    """Every fifth row."""
    return replace(table, cells=table.cells.iloc[::5].reset_index(drop=True)) if len(table.cells) > 1000 else table


def units_said(table: Table, generator: np.random.Generator) -> Table | None:
    """Angles, rates or speeds in another unit, which the headings say."""
    return other_units(table, generator, is_said=True)


MUTATIONS: dict[str, Mutation] = {
    one.__name__: one
    for one in (
        velocities_over_ground, heading_from_east, reversed_side, axes_exchanged, heading_across, upside_down,
        wrapped_elsewhere, other_units, units_said, whole_numbers, scaled_numbers, wrong_header, without_units,
        other_language, thinned, shuffled, decimal_commas,
    )
}  # fmt: skip
"""What is done to a log, in the order in which it is done: to its physics first, then to how it is written."""


def loaded(name: str) -> Table | None:
    """Return a log with its truth; None where it is not there."""
    data = Path(os.environ.get("SEATRIAL_DATA", "../shared/data"))
    path = {"examples": REPOSITORY, "repro": data.parent}.get(name.partition("/")[0], data) / name
    return Table(pd.read_csv(path), _truth(LOGS[name])) if path.exists() else None


def mutated(table: Table, seed: Sequence[int]) -> Table:
    """Return the table after one to three mutations that it can take."""
    generator = np.random.default_rng(list(seed))
    chosen = generator.permutation(list(MUTATIONS))[: int(generator.integers(1, 4))]
    for kind in sorted(chosen, key=list(MUTATIONS).index):
        changed = MUTATIONS[kind](table, generator)
        table = table if changed is None else replace(changed, notes=(*table.notes, str(kind)))
    return table


def outcomes(table: Table, folder: Path) -> dict[str, str]:
    """Return channel -> what the draft makes of it."""
    path = folder / "log.csv"
    table.cells.to_csv(path, sep=table.separator, decimal=table.decimal, index=False)
    try:
        guesses = [g for part in draft_trial(path).guesses for g in part if g.is_used]
    except InputError:
        return {one.symbol: "missing" for one in table.truth.values()}
    found = {}
    for name, one in table.truth.items():
        guess = next((g for g in guesses if str(g.source) == name), None)
        found[one.symbol] = "missing" if guess is None else _outcome(guess, one)
    return found


def _outcome(guess: ColumnGuess, truth: Truth) -> str:
    if guess.is_open:
        return "open"
    frame = truth.frame if truth.frame in ("body", "enu") or truth.symbol in ("u", "v") else ""
    is_frame = guess.frame == frame or (guess.frame != "enu" and frame != "enu" and truth.symbol not in ("u", "v"))
    turn = _full_turn(truth)
    is_zero = abs((guess.offset - truth.offset + 0.5 * turn) % turn - 0.5 * turn) < _SAME_ZERO * turn
    is_side = guess.positive == truth.positive or truth.frame == "enu"
    if (guess.symbol, guess.unit) == (truth.symbol, truth.unit) and is_frame and is_zero and is_side:
        return "right"
    is_marked = guess.is_assumed and guess.unit == truth.unit
    return "assumed, wrong" if is_marked else "silent"


def main() -> None:
    """Print the shares, of the logs as they are and mutated."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=60)
    parser.add_argument("--logs", nargs="*", default=list(LOGS))
    parser.add_argument("--table", action="store_true", help="each log with what is not right of it")
    arguments = parser.parse_args()
    tables = {name: table for name in arguments.logs if (table := loaded(name)) is not None}
    totals = {"as it is": Counter[str](), "mutated": Counter[str]()}
    logs = list(tables.items())
    names = list(tables)
    logs += [
        (names[k % len(names)], mutated(tables[names[k % len(names)]], (arguments.seed, k)))
        for k in range(arguments.count)
    ]
    with tempfile.TemporaryDirectory() as folder:
        for name, table in logs:
            found = outcomes(table, Path(folder))
            totals["mutated" if table.notes else "as it is"].update(found.values())
            odd = {symbol: what for symbol, what in found.items() if what != "right"}
            if arguments.table and odd:
                print(f"{name}: {', '.join(table.notes) or 'as it is'}: {odd}", flush=True)
    for kind, counts in totals.items():
        total = max(counts.total(), 1)
        shares = ", ".join(f"{what} {count / total:.1%}" for what, count in counts.most_common())
        print(f"{kind}: {total} channels, {shares}")
    counts = totals["mutated"]
    total = max(counts.total(), 1)
    either, silent, left_open = (
        (counts["right"] + counts["open"]) / total,
        counts["silent"] / total,
        counts["open"] / total,
    )
    print(f"right or open {either:.1%} (target {RIGHT_OR_OPEN:.0%})")
    print(f"silent {silent:.1%} (target {SILENT:.1%}), open {left_open:.1%} (target {OPEN:.0%})")


if __name__ == "__main__":
    main()
