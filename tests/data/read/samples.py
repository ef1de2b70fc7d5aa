"""Small logs with known contents in every format, written by the format's own library where it writes."""

import json
import math
import struct
from collections.abc import Callable
from dataclasses import dataclass
from functools import reduce
from operator import xor
from pathlib import Path

import numpy as np

from seatrial.data.read import ColumnSpec, Layout, Reader
from seatrial.data.read.formats.ardupilot_bin import read_ardupilot_bin
from seatrial.data.read.formats.ardupilot_tlog import read_ardupilot_tlog
from seatrial.data.read.formats.excel import read_excel
from seatrial.data.read.formats.hdf5 import read_hdf5
from seatrial.data.read.formats.mat import read_mat
from seatrial.data.read.formats.mdf4 import read_mdf4
from seatrial.data.read.formats.netcdf import read_netcdf
from seatrial.data.read.formats.nmea0183 import read_nmea0183
from seatrial.data.read.formats.nmea2000 import read_nmea2000
from seatrial.data.read.formats.parquet import read_parquet
from seatrial.data.read.formats.rosbag import read_rosbag
from seatrial.data.read.formats.signalk import read_signalk
from seatrial.data.read.formats.tdms import read_tdms
from seatrial.data.read.formats.text import read_text
from seatrial.data.read.formats.ulog import read_ulog

TIME = np.arange(60) * 0.2  # s
SPEED = 2.0 + np.round(np.sin(TIME), 3)  # m/s
HEADING = np.round(40.0 + 3.0 * TIME, 2)  # deg


@dataclass(frozen=True)
class Sample:
    """A log to write: its reader, file name, where u [m/s] and psi [rad] stand, and what time of the file is t = 0."""

    format: str
    read: Reader
    file: str
    write: Callable[[Path], None]
    time: str | int
    u: ColumnSpec
    psi: ColumnSpec
    start: float = 0.0
    tolerance: float = 1e-6

    @property
    def layout(self) -> Layout:
        """Time, u and psi."""
        return Layout(self.format, ColumnSpec("time", self.time, "s"), (self.u, self.psi))


def _columns(u: str | int, psi: str | int, unit: str = "deg") -> tuple[ColumnSpec, ColumnSpec]:
    return ColumnSpec("u", u, "m/s"), ColumnSpec("psi", psi, unit)


def write_text(path: Path) -> None:
    rows = zip(TIME.tolist(), SPEED.tolist(), HEADING.tolist(), strict=True)
    path.write_text("t,speed,heading\n" + "".join(f"{t!r},{u!r},{psi!r}\n" for t, u, psi in rows), encoding="utf-8")


def write_mat(path: Path) -> None:
    from scipy.io import savemat

    savemat(path, {"t": TIME, "speed": SPEED, "heading": HEADING})


def write_parquet(path: Path) -> None:
    import pandas as pd

    pd.DataFrame({"t": TIME, "speed": SPEED, "heading": HEADING}).to_parquet(path)


def write_netcdf(path: Path) -> None:
    import xarray as xr

    xr.Dataset({"speed": ("t", SPEED), "heading": ("t", HEADING)}, {"t": TIME}).to_netcdf(path, engine="h5netcdf")


def write_hdf5(path: Path) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        group = file.create_group("nav")
        group["t"], group["speed"], group["heading"] = TIME, SPEED, HEADING
        group["speed"].attrs["units"] = "m/s"


def write_excel(path: Path) -> None:
    import openpyxl

    book = openpyxl.Workbook()
    sheet = book.active
    assert sheet is not None
    sheet.append(["Zigzag of 14 May", None, None])
    sheet.append(["t", "speed", "heading"])
    sheet.append(["[s]", "[m/s]", "[deg]"])
    for row in zip(TIME.tolist(), SPEED.tolist(), HEADING.tolist(), strict=True):
        sheet.append(row)
    book.save(path)


def write_tdms(path: Path) -> None:
    from nptdms import ChannelObject, TdmsWriter

    clock = {"wf_increment": 0.2, "wf_start_offset": 0.0}
    with TdmsWriter(str(path)) as file:
        file.write_segment([
            ChannelObject("nav", "speed", SPEED, {**clock, "unit_string": "m/s"}),
            ChannelObject("nav", "heading", HEADING, clock),
        ])  # fmt: skip


def write_mdf4(path: Path) -> None:
    from asammdf import MDF, Signal

    with MDF(version="4.10") as file:
        file.append([Signal(SPEED, TIME, unit="m/s", name="speed"), Signal(HEADING, TIME, unit="deg", name="heading")])
        file.save(path, overwrite=True)


def write_ros1(path: Path) -> None:
    from rosbags.rosbag1 import Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS1_NOETIC)
    with Writer(path) as bag:
        _write_twists(bag, types, types.serialize_ros1, {})


def write_mcap(path: Path) -> None:
    from rosbags.rosbag2 import StoragePlugin, Writer
    from rosbags.typesys import Stores, get_typestore

    types = get_typestore(Stores.ROS2_HUMBLE)
    folder = path.with_name(f"{path.stem}{path.suffix}_bag")
    plugin = StoragePlugin.MCAP if path.suffix == ".mcap" else StoragePlugin.SQLITE3
    with Writer(folder, version=9, storage_plugin=plugin) as bag:
        _write_twists(bag, types, types.serialize_cdr, {"stamp_type": "ros2"})
    next(folder.glob(f"*{path.suffix}")).rename(path)


def _write_twists(bag, types, serialise, kind: dict) -> None:
    message = types.types
    number = message["std_msgs/msg/Float64"]
    twist, vector = message["geometry_msgs/msg/TwistStamped"], message["geometry_msgs/msg/Vector3"]
    header, stamp = message["std_msgs/msg/Header"], message["builtin_interfaces/msg/Time"]
    speed = bag.add_connection("/nav/twist", twist.__msgtype__, typestore=types)
    heading = bag.add_connection("/nav/heading", number.__msgtype__, typestore=types)
    for k in range(len(TIME)):
        nanoseconds = 1_700_000_000_000_000_000 + round(TIME[k] * 1e9)
        at = stamp(nanoseconds // 10**9, nanoseconds % 10**9)
        head = header(k, at, "base") if not kind else header(at, "base")
        data = twist(head, message["geometry_msgs/msg/Twist"](vector(SPEED[k], 0.0, 0.0), vector(0.0, 0.0, 0.0)))
        bag.write(speed, nanoseconds + 3_000_000, serialise(data, twist.__msgtype__))
        bag.write(heading, nanoseconds, serialise(number(HEADING[k]), number.__msgtype__))


def write_ulog(path: Path) -> None:
    """ULog as PX4 documents it (docs.px4.io, ULog File Format): header, format, subscription, data."""

    def message(kind: bytes, body: bytes) -> bytes:
        return struct.pack("<H", len(body)) + kind + body

    content = bytearray(b"ULog\x01\x12\x35\x01" + struct.pack("<Q", 0))
    content += message(b"B", bytes(40))
    content += message(b"F", b"vehicle_local_position:uint64_t timestamp;float vx;float heading;")
    key = b"float CA_ROTOR0_PX"
    content += message(b"P", bytes([len(key)]) + key + struct.pack("<f", 0.25))
    content += message(b"A", struct.pack("<BH", 0, 1) + b"vehicle_local_position")
    for t, u, psi in zip(TIME, SPEED, HEADING, strict=True):
        content += message(b"D", struct.pack("<HQff", 1, round(t * 1e6), u, math.radians(psi)))
    path.write_bytes(content)


def dataflash(messages: dict[str, tuple[str, str, list[tuple]]]) -> bytes:
    """An ArduPilot log: name -> (letters of the fields, their names, rows); ArduPilot, AP_Logger/LogStructure.h."""
    sizes = {"Q": 8, "f": 4, "L": 4, "B": 1, "N": 16, "H": 2, "c": 2, "d": 8}
    codes = {"Q": "Q", "f": "f", "L": "i", "B": "B", "N": "16s", "H": "H", "c": "h", "d": "d"}
    head, body = b"\xa3\x95", bytearray()
    kinds = {"FMT": (0x80, 89, "BBnNZ", "Type,Length,Name,Format,Columns")}
    for number, (name, (letters, names, _)) in enumerate(messages.items(), start=130):
        kinds[name] = (number, 3 + sum(sizes[letter] for letter in letters), letters, names)
    for name, (number, length, letters, names) in kinds.items():
        body += head + b"\x80" + struct.pack(
            "<BB4s16s64s", number, length, name.encode(), letters.encode(), names.encode()
        )  # fmt: skip
    rows = [(row[0], name, row) for name, (_, _, part) in messages.items() for row in part]
    for _, name, row in sorted(rows, key=lambda one: one[0]):
        number, _, letters, _ = kinds[name]
        body += head + bytes([number]) + struct.pack("<" + "".join(codes[letter] for letter in letters), *row)
    return bytes(body)


def write_ardupilot_bin(path: Path) -> None:
    micro = [round(t * 1e6) for t in TIME]
    motion = [(t, 0, u, psi) for t, u, psi in zip(micro, SPEED.tolist(), HEADING.tolist(), strict=True)]
    parameters = [(0, b"SERVO1_FUNCTION", 26.0), (0, b"SERVO1_REVERSED", 1.0)]
    path.write_bytes(dataflash({
        "PARM": ("QNf", "TimeUS,Name,Value", parameters),
        "MODE": ("QBB", "TimeUS,Mode,ModeNum", [(0, 0, 0), (micro[30], 10, 10)]),
        "XKF1": ("QBff", "TimeUS,C,VN,Yaw", motion),
    }))  # fmt: skip


def write_tlog(path: Path) -> None:
    from pymavlink.dialects.v20 import ardupilotmega as mavlink

    mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=1)
    with path.open("wb") as file:
        for k in range(len(TIME)):
            heading = math.radians(HEADING[k])
            boot = round(TIME[k] * 1e3) + 5000
            messages = [
                mav.attitude_encode(boot, 0.0, 0.0, heading, 0.0, 0.0, 0.05),
                mav.local_position_ned_encode(boot, 0.0, 0.0, 0.0, SPEED[k], 0.0, 0.0),
            ]
            if k == 0:
                messages.insert(0, mav.param_value_encode(b"SERVO1_FUNCTION", 26.0, 9, 1, 0))
                messages.insert(0, mav.heartbeat_encode(11, 3, 0, 0, 4))
            for message in messages:
                file.write(struct.pack(">Q", 1_700_000_000_000_000 + round(TIME[k] * 1e6)) + message.pack(mav))


def sentence(body: str) -> str:
    """The sentence with its checksum."""
    return f"${body}*{reduce(xor, body.encode(), 0):02X}"


def write_nmea0183(path: Path) -> None:
    lines = ["37,T*12"]
    for t, u, psi in zip(TIME, SPEED, HEADING, strict=True):
        clock = f"0227{18 + t:05.2f}"
        lines += [
            sentence(f"GPRMC,{clock},A,2234.03506,N,11431.92532,E,{u / (1852 / 3600):.9f},0.0,051224,3.4,W,D"),
            sentence(f"GNHDT,{psi:.4f},T"),
        ]
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def write_nmea2000(path: Path) -> None:
    lines = ["# format=FAST"]
    for t, u, psi in zip(TIME, SPEED, HEADING, strict=True):
        stamp = f"2026-08-03T05:05:{27 + t:06.3f}Z"
        speed = struct.pack("<BHHBH", 255, round(u * 100), 0xFFFF, 0xFF, 0xFFFF)
        heading = struct.pack("<BHhhB", 255, round(math.radians(psi) * 1e4), 0x7FFF, 0x7FFF, 0xFC)
        for number, data in ((128259, speed), (127250, heading)):
            cells = ",".join(f"{byte:02x}" for byte in data)
            lines.append(f"{stamp},2,{number},35,255,{len(data)},{cells}")
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


def write_signalk(path: Path) -> None:
    lines = ["1785733527000;N;$GPGSV,1,1,00"]
    for t, u, psi in zip(TIME, SPEED, HEADING, strict=True):
        values = [("navigation.speedThroughWater", u), ("navigation.headingTrue", math.radians(psi)), ("name", "Anna")]
        update = {"timestamp": f"2026-08-03T05:05:{27 + t:06.3f}Z",
                  "values": [{"path": name, "value": value} for name, value in values]}  # fmt: skip
        lines.append(f"{1785733527000 + round(1000 * t)};I;{json.dumps({'updates': [update]})}")
    path.write_text("\n".join(lines) + "\n", encoding="ascii")


_NAMED = _columns("speed", "heading")
_ROS = _columns("/nav/twist/twist.linear.x", "/nav/heading/data")
_EPOCH = 1_700_000_000.0
SAMPLES = {
    sample.file: sample
    for sample in (
        Sample("text", read_text, "run.csv", write_text, "t", *_NAMED),
        Sample("mat", read_mat, "run.mat", write_mat, "t", *_NAMED),
        Sample("parquet", read_parquet, "run.parquet", write_parquet, "t", *_NAMED),
        Sample("netcdf", read_netcdf, "run.nc", write_netcdf, "t", *_NAMED),
        Sample("hdf5", read_hdf5, "run.h5", write_hdf5, "nav/t", *_columns("nav/speed", "nav/heading")),
        Sample("excel", read_excel, "run.xlsx", write_excel, "t", *_NAMED),
        Sample("tdms", read_tdms, "run.tdms", write_tdms, "", *_columns("nav/speed", "nav/heading")),
        Sample("mdf4", read_mdf4, "run.mf4", write_mdf4, "", *_NAMED),
        Sample("rosbag", read_rosbag, "run.bag", write_ros1, "", *_ROS, _EPOCH),
        Sample("rosbag", read_rosbag, "run.mcap", write_mcap, "", *_ROS, _EPOCH),
        Sample("rosbag", read_rosbag, "run.db3", write_mcap, "", *_ROS, _EPOCH),
        Sample("ulog", read_ulog, "run.ulg", write_ulog, "",
               *_columns("vehicle_local_position/vx", "vehicle_local_position/heading", "rad")),
        Sample("ardupilot-bin", read_ardupilot_bin, "run.bin", write_ardupilot_bin, "",
               *_columns("XKF1/VN", "XKF1/Yaw")),
        Sample("ardupilot-tlog", read_ardupilot_tlog, "run.tlog", write_tlog, "",
               *_columns("LOCAL_POSITION_NED/vx", "ATTITUDE/yaw", "rad"), _EPOCH),
        Sample("nmea0183", read_nmea0183, "run.nmea", write_nmea0183, "", *_columns("RMC/north", "HDT/heading", "rad"),
               1733365638.0),
        Sample("nmea2000", read_nmea2000, "run.n2k", write_nmea2000, "",
               *_columns("speed/speedWaterReferenced", "vesselHeading:True/heading", "rad"), 1785733527.0, 6e-3),
        Sample("signalk", read_signalk, "run.log", write_signalk, "", *_columns(
            "navigation.speedThroughWater/speedThroughWater", "navigation.headingTrue/headingTrue", "rad"),
            1785733527.0),
    )
}  # fmt: skip
