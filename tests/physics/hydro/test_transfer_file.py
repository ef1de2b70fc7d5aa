"""Transfer functions from files: what comes out of the box hull goes in again; bad tables are named."""

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from seatrial.core.values import Array, InputError
from seatrial.physics.hydro.excitation import BoxHull
from seatrial.physics.hydro.tabulated import read_transfer

HULL = BoxHull(L=60.0, B=7.14, T=2.27, c33=3.15e6, c35=6.83e6, c53=6.83e6, c55=6.54e8)
OMEGA = np.linspace(0.3, 2.0, 120)
HEADINGS = np.arange(0.0, 181.0, 7.5)
SPEED = 3.0


def _frame(omega: Array = OMEGA, headings: Array = HEADINGS) -> pd.DataFrame:
    rows = []
    for degrees in headings:
        F3, M5 = HULL.forces(omega, SPEED, np.radians(degrees))
        rows.append(pd.DataFrame({"omega": omega, "heading_deg": degrees, "F3": F3, "M5": M5}))
    return pd.concat(rows, ignore_index=True)


def _parts(frame: pd.DataFrame) -> pd.DataFrame:
    out = frame[["omega", "heading_deg"]].copy()
    for name in ("F3", "M5"):
        out[f"{name}_real"], out[f"{name}_imag"] = np.real(frame[name]), np.imag(frame[name])
    return out


def _polar(frame: pd.DataFrame) -> pd.DataFrame:
    out = frame[["omega", "heading_deg"]].copy()
    for name in ("F3", "M5"):
        out[f"{name}_amplitude"] = np.abs(frame[name])
        out[f"{name}_phase_deg"] = np.degrees(np.angle(frame[name]))
    return out


@pytest.mark.parametrize("columns", [_parts, _polar])
def test_the_table_gives_back_what_was_written(tmp_path: Path, columns: object) -> None:
    path = tmp_path / "hull.csv"
    columns(_frame()).sample(frac=1.0, random_state=1).to_csv(path, index=False)  # type: ignore[operator]
    read = read_transfer(path, speed=SPEED)
    for degrees in (0.0, 90.0, 135.0, 180.0):
        for ours, theirs in zip(
            read.forces(OMEGA, SPEED, np.radians(degrees)), HULL.forces(OMEGA, SPEED, np.radians(degrees)), strict=True
        ):
            np.testing.assert_allclose(ours, theirs, atol=1e-9 * np.abs(theirs).max())


def test_between_the_points_it_closes_in_on_the_hull(tmp_path: Path) -> None:
    """Twice as many points leave less than a third of the error, as an interpolation of second order does."""
    rng = np.random.default_rng(3)
    omega, beta = rng.uniform(0.31, 1.6, 400), rng.uniform(-np.pi, np.pi, 400)
    worst = []
    for refine in (1, 2, 4):
        path = tmp_path / f"hull_{refine}.csv"
        _parts(_frame(np.linspace(0.3, 2.0, 30 * refine), np.linspace(0.0, 180.0, 12 * refine + 1))).to_csv(path)
        read, true = read_transfer(path).forces(omega, SPEED, beta), HULL.forces(omega, SPEED, beta)
        worst.append([np.sqrt(np.mean(np.abs(a - b) ** 2)) for a, b in zip(read, true, strict=True)])
    coarse, middle, fine = np.array(worst)
    assert np.all(middle < coarse / 3) and np.all(fine < middle / 3)


def test_one_heading_without_a_column(tmp_path: Path) -> None:
    path = tmp_path / "head.csv"
    frame = _parts(_frame())
    frame[frame.heading_deg == 180.0].drop(columns="heading_deg").to_csv(path, index=False)
    with pytest.raises(InputError, match="heading_deg"):
        read_transfer(path)
    read = read_transfer(path, heading_deg=180.0)
    np.testing.assert_allclose(read.forces(OMEGA, 0.0, -np.pi)[0], HULL.forces(OMEGA, SPEED, np.pi)[0], rtol=1e-9)
    with pytest.raises(InputError, match="heading 180 to 180 degrees"):
        read.forces(OMEGA, 0.0, 2.0)


def test_netcdf_holds_the_same(tmp_path: Path) -> None:
    pytest.importorskip("xarray", reason="xarray is not installed (extra formats)")
    pytest.importorskip("h5netcdf", reason="h5netcdf is not installed (extra formats)")
    path = tmp_path / "hull.nc"
    _parts(_frame()).set_index(["omega", "heading_deg"]).to_xarray().to_netcdf(path, engine="h5netcdf")
    beta = np.radians(HEADINGS[17])
    for ours, theirs in zip(
        read_transfer(path).forces(OMEGA, SPEED, beta), HULL.forces(OMEGA, SPEED, beta), strict=True
    ):
        np.testing.assert_allclose(ours, theirs, atol=1e-9 * np.abs(theirs).max())


def test_nothing_is_extrapolated(tmp_path: Path) -> None:
    path = tmp_path / "hull.csv"
    _parts(_frame()).to_csv(path, index=False)
    read = read_transfer(path, speed=SPEED)
    with pytest.raises(InputError, match=r"hull.csv covers wave frequency 0.3 to 2 rad/s.*2.5"):
        read.forces(np.array([1.0, 2.5]), SPEED, 0.0)
    with pytest.raises(InputError, match="holds at 3 m/s"):
        read.forces(OMEGA, 5.0, 0.0)


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("omega,heading_deg,F3_real,F3_imag,M5_real\n1,0,1,1,1\n", "no column 'M5_imag'"),
        ("omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag\n1,0,1,1,1,1\n2,0,1,x,1,1\n", "'F3_imag', row 2"),
        ("omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag\n1,0,1,1,1,1\n2,0,1,,1,1\n", "'F3_imag', row 2"),
        ("omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag\n1,0,1,1,1,1\n1,0,1,1,1,1\n", "2 rows"),
        ("omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag\n1,0,1,1,1,1\n2,9,1,1,1,1\n", "no row"),
        ("omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag\n1,0,1,1,1,1\n", "at least two"),
        ("omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag\n", "no rows"),
        ("omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag\n1,270,1,1,1,1\n2,270,1,1,1,1\n", "between 0"),
        ("omega,heading_deg,F3_real,F3_imag,M5_real,M5_imag\n1,0,1,0,1,0\n2,0,-1,0,1,0\n", "too coarse"),
    ],
)
def test_bad_tables_are_named(tmp_path: Path, text: str, words: str) -> None:
    path = tmp_path / "bad.csv"
    path.write_text(text, encoding="utf-8")
    with pytest.raises(InputError, match=words):
        read_transfer(path)


def test_a_file_that_is_not_there(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no file"):
        read_transfer(tmp_path / "none.csv")
