"""MATLAB, Parquet and NetCDF give the same record as text; missing extras are named."""

import sys
from pathlib import Path

import numpy as np
import pytest
from scipy.io import savemat

from seatrial.core.values import InputError
from seatrial.data.read import FORMATS, ColumnSpec, Layout, read_record

T, U = np.arange(6) * 0.1, np.array([1.0, 1.1, np.nan, 1.3, 1.4, 1.5])


def layout(format: str, prefix: str = "") -> Layout:
    return Layout(format, ColumnSpec("time", f"{prefix}t", "s"), (ColumnSpec("u", f"{prefix}speed", "m/s"),))  # type: ignore[arg-type]


def expect(path: Path, wanted: Layout) -> None:
    record = read_record(path, wanted)
    np.testing.assert_array_equal(record.time, T)
    np.testing.assert_array_equal(record["u"], U)


def test_matlab_vectors_structs_and_matrices(tmp_path: Path) -> None:
    path = tmp_path / "run.mat"
    savemat(path, {"t": T, "speed": U[:, None], "remark": "text", "other": np.eye(3)})
    expect(path, layout("mat"))
    savemat(path, {"run": {"t": T, "speed": U}})
    expect(path, layout("mat", "run."))
    savemat(path, {"data": np.column_stack([T, U])})
    expect(path, Layout("mat", ColumnSpec("time", 1, "s"), (ColumnSpec("u", 2, "m/s"),)))


def test_matlab_lengths_must_agree(tmp_path: Path) -> None:
    savemat(tmp_path / "run.mat", {"t": T, "speed": U[:-1]})
    with pytest.raises(InputError, match="'speed' has 5 samples, time has 6"):
        read_record(tmp_path / "run.mat", layout("mat"))


def test_matlab_7_3(tmp_path: Path) -> None:
    h5py = pytest.importorskip("h5py")
    path = tmp_path / "run.mat"
    with h5py.File(path, "w", userblock_size=512) as file:
        file["t"], file["speed"] = T[None], U[None]
    expect(path, layout("mat"))


def test_parquet(tmp_path: Path) -> None:
    pytest.importorskip("pyarrow")
    import pandas as pd

    pd.DataFrame({"t": T, "speed": U}).to_parquet(tmp_path / "run.parquet")
    expect(tmp_path / "run.parquet", layout("parquet"))


def test_netcdf(tmp_path: Path) -> None:
    xr = pytest.importorskip("xarray")
    pytest.importorskip("h5netcdf")
    xr.Dataset({"speed": ("t", U), "grid": ("k", np.zeros(3))}, {"t": T}).to_netcdf(tmp_path / "run.nc")
    expect(tmp_path / "run.nc", layout("netcdf"))


EXTRAS = {
    "parquet": ("pyarrow.parquet", "formats"),
    "netcdf": ("xarray", "formats"),
    "nmea2000": ("nmea2000", "logs"),
    "ardupilot-bin": ("pymavlink.DFReader", "logs"),
    "ardupilot-tlog": ("pymavlink.mavutil", "logs"),
    "rosbag": ("rosbags.highlevel", "logs"),
    "ulog": ("pyulog", "logs"),
    "excel": ("openpyxl", "logs"),
    "hdf5": ("h5py", "logs"),
    "tdms": ("nptdms", "logs"),
    "mdf4": ("asammdf", "logs"),
}


@pytest.mark.parametrize("format", EXTRAS)
def test_a_missing_extra_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, format: str) -> None:
    module, extra = EXTRAS[format]
    path = tmp_path / "run.bin"
    path.write_bytes(b"anything")
    monkeypatch.setitem(sys.modules, module, None)
    with pytest.raises(InputError, match=rf"pip install 'seatrial\[{extra}\]'"):
        FORMATS[format].reader()(path, layout(format))
