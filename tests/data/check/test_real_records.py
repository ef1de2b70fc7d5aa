"""What the checks find unaided on measured records, and that they leave rightly declared ones in peace."""

from collections import Counter
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import Finding, Record, Severity
from seatrial.data.check import canonical_record, examined_record
from seatrial.data.draft.manoeuvres import find_stretches
from seatrial.data.read import ColumnSpec, Layout, read_record
from seatrial.physics.manoeuvres import recognise_manoeuvre

HSVA_FILES, ESSO_FILES = 13, 23

examined = cache(examined_record)


def hsva(naive: bool) -> Layout:
    """Columns as their headers call them, or as they are."""
    frame = "body" if naive else "earth"
    columns = [
        ColumnSpec("x0", 2, "m"),
        ColumnSpec("y0", 3, "m"),
        ColumnSpec("psi", 4, "deg"),
        ColumnSpec("u", 5, "m/s", frame=frame),
        ColumnSpec("v", 6, "m/s", frame=frame),
        ColumnSpec("p" if naive else "r", 7, "deg/s"),
        ColumnSpec("delta", 9, "deg", positive="starboard" if naive else "port"),
        ColumnSpec("n", 10, "rps"),
        ColumnSpec("thrust", 11, "N"),
        ColumnSpec("torque", 12, "N m"),
    ]
    unnamed = [ColumnSpec("r", 8, "deg/s")] if naive else []
    return Layout("text", ColumnSpec("time", 1, "s"), (*columns, *unnamed), header_lines=5, encoding="cp1252")


def esso_osaka(rudder: str) -> Layout:
    columns = (
        ColumnSpec("x0", "x_position_mid [m]", "m"),
        ColumnSpec("y0", "y_position_mid [m]", "m"),
        ColumnSpec("psi", "psi_hat [rad]", "rad"),
        ColumnSpec("u", "u_velo [m/s]", "m/s"),
        ColumnSpec("v", "vm_velo [m/s]", "m/s"),
        ColumnSpec("r", "r_angvelo [rad/s]", "rad/s"),
        ColumnSpec("n", "n_prop [rps]", "rps"),
        ColumnSpec("delta", "delta_rudder [rad]", "rad", positive=rudder),
        ColumnSpec("wind_speed", "wind_velo_true [m/s]", "m/s"),
        ColumnSpec("wind_direction", "wind_dir_true [rad]", "rad"),
    )
    return Layout("text", ColumnSpec("time", "t [s]", "s"), columns)


def all_records(files: list[Path], layout: Layout, expected: int) -> list[Record]:
    if len(files) < expected:
        pytest.skip(f"{expected} files expected, {len(files)} found")
    return [read_record(file, layout) for file in files]


@cache
def hsva_records(folder: Path, *, naive: bool) -> list[Record]:
    return all_records(sorted(folder.glob("kvlcc2_hsva/*.dat")), hsva(naive), HSVA_FILES)


@cache
def esso_records(folder: Path, rudder: str) -> list[Record]:
    return all_records(sorted(folder.glob("esso_osaka/*/*.csv")), esso_osaka(rudder), ESSO_FILES)


def examine(record: Record) -> tuple[Finding, ...]:
    return examined(record).findings


def errors(findings: tuple[Finding, ...]) -> list[str]:
    return sorted(f.code for f in findings if f.severity is Severity.ERROR)


@pytest.mark.long(every=5)
@pytest.mark.parametrize("fifth", range(5))
def test_hsva_headers_are_refuted_on_every_file(data_folder: Path, fifth: int) -> None:
    """The side of the rudder too."""
    for record in hsva_records(data_folder, naive=True)[fifth::5]:
        findings = examine(record)
        assert {*errors(findings)} == {"mislabelled", "wrong-frame", "wrong-sign"}, record.name
        said = {f.code: f.message for f in findings}
        assert "'u' (column 5), 'v' (column 6) are earth-fixed" in said["wrong-frame"]
        assert "'r' (column 8) and 'p' (column 7) have changed places" in said["mislabelled"]
        assert "'delta' (column 9) has the opposite sign" in said["wrong-sign"]


def test_hsva_rightly_declared_has_no_error_and_no_warning(data_folder: Path) -> None:
    for record in hsva_records(data_folder, naive=False):
        assert {f.severity for f in examine(record)} <= {Severity.INFO}, record.name


def test_hsva_at_another_reference_point_is_seen_in_closure(data_folder: Path) -> None:
    """v declared at the centre of gravity .2436 m ahead while it belongs to the positions' point."""
    for record in hsva_records(data_folder, naive=False)[2:]:
        clean = canonical_record(examined(record).record)
        v = clean.channel("v").with_values(clean["v"] + 0.2436 * clean["r"])
        closure = [f for f in examine(clean.with_channel("v", v)) if f.code == "closure"]
        if np.ptp(clean["psi"]) > 0.3:
            said = closure[0].message.split("a point ")[1].split()[0]
            assert float(said) == pytest.approx(0.2436, abs=0.01), record.name


def test_esso_osaka_rightly_declared_has_no_error(data_folder: Path) -> None:
    for record in esso_records(data_folder, "starboard"):
        assert errors(examine(record)) == [], record.name


@pytest.mark.long(every=5)
@pytest.mark.parametrize("fifth", range(5))
def test_esso_osaka_rudder_sign(data_folder: Path, fifth: int) -> None:
    """Declared port: an error on every file, of turns in wind with the rudder at one side too."""
    for record in esso_records(data_folder, "port")[fifth::5]:
        assert [f.severity for f in examine(record) if "'delta'" in f.message] == [Severity.ERROR], record.name


def test_zigzags_and_turns_in_whole_degrees_show_by_rudder_and_by_heading(data_folder: Path) -> None:
    for record in [*hsva_records(data_folder, naive=False), *esso_records(data_folder, "starboard")]:
        wanted = "circle" if "turn" in record.name else "zigzag"
        if "berthing" not in record.name:
            clean = canonical_record(examined(record).record)
            for symbol in ("psi", "delta"):
                degrees = np.radians(np.round(np.degrees(clean[symbol])))
                clean = clean.with_channel(symbol, clean.channel(symbol).with_values(degrees))
            coarse = clean.resampled(5.0)
            assert wanted in recognise_manoeuvre(coarse), record.name
            assert wanted in {stretch.kind for stretch in find_stretches((), coarse)}, record.name


def test_esso_osaka_empty_rows_are_reported_and_cut(data_folder: Path) -> None:
    (file,) = data_folder.glob("esso_osaka/zigzag/zigzag_31-Jul-2020_13_50_28.csv")
    every = Layout("text", ColumnSpec("time", 1, "s"), _all_columns(), header_lines=1)
    record = read_record(file, every)
    assert len(record) == 2028
    assert sum(int(np.isnan(c.values).sum()) for c in record.channels.values()) + np.isnan(record.time).sum() == 4251
    clean, findings = examined(record).record, examine(record)
    rows = next(f for f in findings if f.code == "empty-rows")
    assert "327 empty rows" in rows.message and "4251 empty cells" in rows.evidence
    assert len(clean) == 1701 and clean.is_uniform
    assert all(np.isfinite(c.values).all() for c in clean.channels.values())


def _all_columns() -> tuple[ColumnSpec, ...]:
    units = ["m", "m/s", "m", "m/s", "rad", "rad/s", "rps", "rad", "m/s", "rad", "m/s", "rad"]
    symbols = ["x0", "u", "y0", "v", "psi", "r", "n", "delta", "wind_speed_relative", "wind_direction_relative"]
    symbols += ["wind_speed", "wind_direction"]
    return tuple(ColumnSpec(s, k + 2, unit) for k, (s, unit) in enumerate(zip(symbols, units, strict=True)))


def test_esso_osaka_jumps_lags_and_phases(data_folder: Path) -> None:
    found: Counter[str] = Counter()
    largest, lags = 0.0, []
    for record in esso_records(data_folder, "starboard"):
        findings = {f.code: f for f in examine(record)}
        found.update(findings.keys())
        if "jump" in findings:
            largest = max(largest, float(findings["jump"].evidence.split("up to ")[1].split()[0]))
        lags.append(float(findings["closure"].message.split("a lag of ")[1].split()[0]))
    assert found["jump"] >= 20 and 0.6 < largest < 0.75
    assert found["acceleration-phase"] == ESSO_FILES
    assert found["coasting"] >= 18
    assert 0.9 < np.median(lags) < 1.0


def test_roll_decay_at_rest_raises_no_error(data_folder: Path) -> None:
    for file in sorted(data_folder.glob("kvlcc2_rolldecay/model_test_2*.csv")):
        units = {"x": "m", "y": "m", "phi": "rad", "psi": "rad"}
        columns = tuple(ColumnSpec(name if len(name) > 1 else f"{name}0", name, unit) for name, unit in units.items())
        record = read_record(file, Layout("text", ColumnSpec("time", "time", "s"), columns))
        assert errors(examine(record)) == []
        assert examined(record).record.is_uniform
