"""Cost of reading binary logs of 10 MB: our reader over the format's own library taking the same fields as arrays.

`python benchmarks/binary_formats.py [FORMAT...]`. Processor time in one process, the least of several readings; what a
reading in a process of its own costs besides (its start, its imports and the way back) stands in the last column.
"""

import sys
import tempfile
import time
from collections import defaultdict
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from measure import at_most, machine

sys.path.insert(0, str(Path(__file__).parents[1]))
from benchmarks.checking import cpu_time
from tests.data.read import samples
from tests.data.read.samples import SAMPLES, Sample

from seatrial.data.read.record_file import read_log

SIZE = 10e6  # bytes of a log
LIMIT = 1.25  # times the library: four fifths of its speed, required
FAST_S, REPEATS = 0.2, 20  # s of a reading below which it is repeated so often; slower ones twice; the least counts
TRIAL_ROWS = 1000  # of a log from which the bytes of a row are counted
Columns = dict[str, np.ndarray]


def library_bin(path: Path) -> object:
    """Read every message of an ArduPilot log with pymavlink."""
    from pymavlink.DFReader import DFReader_binary

    log, rows = DFReader_binary(str(path)), defaultdict(list)
    while (message := log.recv_msg()) is not None:
        rows[message.get_type()].append(message._elements)
    return {kind: np.array(part) for kind, part in rows.items() if kind == "XKF1"}


def library_tlog(path: Path) -> object:
    """Read every message of a telemetry log with pymavlink."""
    from pymavlink import mavutil

    log, rows = mavutil.mavlogfile(str(path)), defaultdict(list)
    while (message := log.recv_match()) is not None:
        names = message.get_fieldnames()
        rows[message.get_type()].append([message._timestamp, *(getattr(message, name) for name in names)])
    return {kind: np.array(part, dtype=float) for kind, part in rows.items() if len(part) > 1}


def library_bag(path: Path) -> object:
    """Read the twist (seven numbers of it) and the heading of a bag with rosbags."""
    from rosbags.highlevel import AnyReader
    from rosbags.typesys import Stores, get_typestore

    store, rows = Stores.ROS1_NOETIC if path.suffix == ".bag" else Stores.ROS2_HUMBLE, defaultdict(list)
    with AnyReader([path], default_typestore=get_typestore(store)) as bag:
        for connection, recorded, data in bag.messages():
            message = bag.deserialize(data, connection.msgtype)
            if connection.topic == "/nav/heading":
                rows[connection.topic].append((recorded, message.data))
            else:
                stamp, v, w = message.header.stamp, message.twist.linear, message.twist.angular
                rows[connection.topic].append((recorded, stamp.sec, stamp.nanosec, v.x, v.y, v.z, w.x, w.y, w.z))
    return {topic: np.array(part, dtype=float) for topic, part in rows.items()}


def library_ulog(path: Path) -> object:
    """Read a ULog file with pyulog."""
    from pyulog import ULog

    return [data.data for data in ULog(str(path)).data_list]


def library_excel(path: Path) -> object:
    """Read the rows of a workbook with openpyxl."""
    from openpyxl import load_workbook

    rows = list(load_workbook(path, read_only=True, data_only=True).worksheets[0].iter_rows(values_only=True))
    return np.array(rows[3:], dtype=float)


def library_hdf5(path: Path) -> object:
    """Read the datasets of a file with h5py."""
    import h5py

    with h5py.File(path) as file:
        return {name: item[()] for name, item in file["nav"].items()}


def library_mat(path: Path) -> object:
    """Read a version 5 file with scipy."""
    from scipy.io import loadmat

    return loadmat(path, squeeze_me=True)


def library_tdms(path: Path) -> object:
    """Read the channels of a file with npTDMS, and their time."""
    from nptdms import TdmsFile

    channels = TdmsFile.read(path)["nav"].channels()
    return [channels[0].time_track(), *(channel[:] for channel in channels)]


def library_mdf4(path: Path) -> object:
    """Read the channels of a file with asammdf."""
    from asammdf import MDF

    with MDF(path) as file:
        return [file.get_master(0), file.get("speed").samples, file.get("heading").samples]


def library_parquet(path: Path) -> object:
    """Read a table with pyarrow."""
    from pyarrow.parquet import read_table

    return [column.to_numpy() for column in read_table(path).columns]


def library_netcdf(path: Path) -> object:
    """Read a file with xarray."""
    from xarray import load_dataset

    return {name: array.values for name, array in load_dataset(path, decode_times=False).variables.items()}


LIBRARIES: dict[str, Callable[[Path], object]] = {
    "run.bin": library_bin, "run.tlog": library_tlog, "run.bag": library_bag, "run.mcap": library_bag,
    "run.db3": library_bag, "run.ulg": library_ulog, "run.xlsx": library_excel, "run.h5": library_hdf5,
    "run.mat": library_mat, "run.tdms": library_tdms, "run.mf4": library_mdf4, "run.parquet": library_parquet,
    "run.nc": library_netcdf,
}  # fmt: skip


def write_large(sample: Sample, folder: Path) -> Path:
    """Write a log of the sample's kind of some 10 MB; numbers of full precision, which no packing makes small."""
    path, generator = folder / sample.file, np.random.default_rng(7)
    rows = TRIAL_ROWS
    for _ in range(3):
        path.unlink(missing_ok=True)
        for rest in folder.glob("*_bag"):
            rest.rename(folder / f"written_{rows}")
        samples.TIME = np.arange(rows) * 0.01  # s; the writers of the samples take what stands here
        samples.SPEED = 2.0 + generator.standard_normal(rows)
        samples.HEADING = generator.uniform(0.0, 360.0, rows)
        sample.write(path)
        rows = round(rows * SIZE / path.stat().st_size)
    return path


def least_cost(read: Callable[[], object]) -> float:
    """Return the least processor time of several readings [s]."""
    first = cpu_time(read, 1)
    return min(first, cpu_time(read, REPEATS if first < FAST_S else 1))


def main(names: list[str]) -> None:
    """Print a line for each format."""
    print(machine())
    for name, library in LIBRARIES.items():
        sample = SAMPLES[name]
        if names and sample.format not in names and name not in names:
            continue
        with tempfile.TemporaryDirectory() as folder:
            path = write_large(sample, Path(folder))
            spent, theirs = least_cost(partial(sample.read, path, sample.layout)), least_cost(partial(library, path))
            began = time.perf_counter()
            read_log(path, sample.layout)
            besides = time.perf_counter() - began - spent
            line = at_most(name, spent / theirs, "", LIMIT)
            print(f"{name:<12} {path.stat().st_size / 1e6:5.1f} MB {spent:8.3f} s, library {theirs:8.3f} s, "
                  f"ratio {line.value:5.2f} {line.verdict}; +{besides:.2f} s in a process", flush=True)  # fmt: skip


if __name__ == "__main__":
    main(sys.argv[1:])
