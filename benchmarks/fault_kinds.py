"""Faults of a stated size that are planted in records, and the finding that should name each."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.values import Array, Finding, Record

Spoil = Callable[[Record, np.random.Generator], Record]
LAG_SAMPLES = (3, 12)  # rows by which a channel is late; the lower end is the required size
LEVER_LENGTHS = (0.1, 0.4)  # of the ship, by which velocities are referred to another point
SIGMAS = (3.0, 6.0)  # standard deviations of the noise of u that a bias has
HOLD_SHARE = 0.1  # of a record, during which a sensor stands still
WILD_SAMPLES = 5  # single ones
GAP_S = 60.0  # s that are missing
TURN, KNOT = 180.0 / np.pi, 1852.0 / 3600.0  # degrees of a radian; m/s of a knot


@dataclass(frozen=True)
class FaultKind:
    """A kind of fault: how it is planted, and by which code and words of a finding it is named.

    Attributes:
        code, words: of the finding, ... for what stands between them; also: another code with its words, where two
            readings are one.
    """

    name: str
    spoil: Spoil
    code: str
    words: str = ""
    also: tuple[str, str] | None = None

    def names(self, finding: Finding) -> bool:
        """Whether a finding names the fault."""
        pairs = [(self.code, self.words), *([self.also] if self.also else [])]
        parts = ((code, words.split("...")) for code, words in pairs)
        return any(code == finding.code and all(part in finding.message for part in words) for code, words in parts)


def with_values(record: Record, **values: Array) -> Record:
    """Return the record with other values in some channels."""
    channels = {symbol: record.channel(symbol).with_values(array) for symbol, array in values.items()}
    return replace(record, channels={**record.channels, **channels})


def _scaled(**factors: float) -> Spoil:
    return lambda record, _: with_values(record, **{symbol: k * record[symbol] for symbol, k in factors.items()})


def _exchanged(one: str, other: str) -> Spoil:
    return lambda record, _: with_values(record, **{one: record[other], other: record[one]})


def _late(*symbols: str) -> Spoil:
    def spoil(record: Record, generator: np.random.Generator) -> Record:
        k = int(generator.integers(*LAG_SAMPLES))
        late = {symbol: np.roll(record[symbol], k) for symbol in symbols}
        return with_values(record, **late).rows(slice(k, None))

    return spoil


def _earth_fixed(record: Record) -> tuple[Array, Array]:
    c, s = np.cos(record["psi"]), np.sin(record["psi"])
    return record["u"] * c - record["v"] * s, record["u"] * s + record["v"] * c


def _earth_called_body(record: Record, _: np.random.Generator) -> Record:
    north, east = _earth_fixed(record)
    return with_values(record, u=north, v=east)


def _lever(record: Record, generator: np.random.Generator) -> Record:
    return with_values(record, v=record["v"] + _distance(record, generator) * record["r"])


def _unturned_lever(record: Record, generator: np.random.Generator) -> Record:
    """Body velocities whose earth-fixed east part was moved by the lever, without turning it."""
    north, east = _earth_fixed(record)
    east = east + 2.0 * _distance(record, generator) * record["r"]
    c, s = np.cos(record["psi"]), np.sin(record["psi"])
    return with_values(record, u=north * c + east * s, v=east * c - north * s)


def _distance(record: Record, generator: np.random.Generator) -> float:
    """Distance of a point [m], of the length that the name of the record ends with."""
    length = float(record.name.rpartition(" L ")[2])
    return float(generator.uniform(*LEVER_LENGTHS) * length * generator.choice([-1.0, 1.0]))


def _offset_heading(low: float, high: float) -> Spoil:
    def spoil(record: Record, generator: np.random.Generator) -> Record:
        angle = np.radians(generator.uniform(low, high)) * generator.choice([-1.0, 1.0])
        return with_values(record, psi=record["psi"] + angle)

    return spoil


def _biased_log(record: Record, generator: np.random.Generator) -> Record:
    noise = float(np.std(np.diff(record["u"], 3))) / np.sqrt(20.0)  # 1 + 9 + 9 + 1: variance of third differences
    size = max(noise * generator.uniform(*SIGMAS), 0.02 * float(np.mean(np.abs(record["u"]))))  # at least 2 % of speed
    return with_values(record, u=record["u"] + size * generator.choice([-1.0, 1.0]))


def _current(record: Record, generator: np.random.Generator) -> Record:
    speed, angle = 0.1 * float(np.mean(np.abs(record["u"]))), generator.uniform(0.0, 2.0 * np.pi)
    t = record.time - record.time[0]
    return with_values(record, x0=record["x0"] + speed * np.cos(angle) * t, y0=record["y0"] + speed * np.sin(angle) * t)


def _stuck(record: Record, generator: np.random.Generator) -> Record:
    count = int(HOLD_SHARE * len(record))
    first = int(generator.integers(0, len(record) - count))
    r = np.array(record["r"])
    r[first : first + count] = r[first]
    return with_values(record, r=r)


def _wild(record: Record, generator: np.random.Generator) -> Record:
    psi, rows = np.array(record["psi"]), generator.choice(len(record) - 40, WILD_SAMPLES, replace=False) + 20
    psi[rows] += generator.choice([-1.0, 1.0], WILD_SAMPLES)  # rad
    return with_values(record, psi=psi)


def _jump(record: Record, generator: np.random.Generator) -> Record:
    x, row = np.array(record["x0"]), int(generator.integers(len(record) // 4, 3 * len(record) // 4))
    x[row:] += 50.0 * float(np.median(np.hypot(np.diff(record["x0"]), np.diff(record["y0"]))))  # steps of the track
    return with_values(record, x0=x)


def _gap(record: Record, generator: np.random.Generator) -> Record:
    gap = min(GAP_S, record.duration / 4.0)
    start = record.time[0] + generator.uniform(0.3, 0.6) * record.duration
    keep = (record.time < start) | (record.time > start + gap)
    channels = {symbol: channel.with_values(channel.values[keep]) for symbol, channel in record.channels.items()}
    return replace(record, time=record.time[keep], channels=channels)


def _repeated(record: Record, generator: np.random.Generator) -> Record:
    rows = np.sort(np.concatenate([np.arange(len(record)), generator.choice(len(record), 50, replace=False)]))
    channels = {symbol: channel.with_values(channel.values[rows]) for symbol, channel in record.channels.items()}
    return replace(record, time=record.time[rows], channels=channels)


def _mislabelled(record: Record, _: np.random.Generator) -> Record:
    p = Record.from_arrays("p", record.time, {"p": record["r"]}).channel("p")
    return with_values(record, r=np.gradient(record["r"], record.dt)).with_channel("p", p)


def _still(record: Record, _: np.random.Generator) -> Record:
    return with_values(record, delta=np.full(len(record), 0.01))


KINDS = (
    FaultKind("sign of the rudder", _scaled(delta=-1.0), "wrong-sign", "'delta'"),
    FaultKind("sign of the heading", _scaled(psi=-1.0), "wrong-sign", "'psi'"),
    FaultKind("sign of the yaw rate", _scaled(r=-1.0), "wrong-sign", "'r'"),
    FaultKind("sign of sway", _scaled(v=-1.0), "closure", "v with the opposite sign"),
    FaultKind("sign of y0", _scaled(y0=-1.0), "wrong-sign", "'y0'"),
    FaultKind("x0 and y0 exchanged", _exchanged("x0", "y0"), "wrong-frame", "'x0'...are exchanged"),
    FaultKind("u and v exchanged", _exchanged("u", "v"), "mislabelled", "'u'...'v'"),
    FaultKind("earth-fixed called body-fixed", _earth_called_body, "wrong-frame", "earth-fixed"),
    FaultKind("heading from east", lambda r, _: with_values(r, psi=np.pi / 2.0 - r["psi"]), "wrong-frame", "from east"),
    FaultKind("heading in degrees", _scaled(psi=TURN), "wrong-unit", "'psi'... is in deg"),
    FaultKind("yaw rate in deg/s", _scaled(r=TURN), "wrong-unit", "'r'... is in deg/s"),
    FaultKind("yaw rate in deg/min", _scaled(r=60.0 * TURN), "wrong-unit", "'r'... is in deg/min"),  # s of a minute
    FaultKind("rudder in degrees", _scaled(delta=TURN), "wrong-unit", "'delta'... is in deg"),
    FaultKind("speed in knots", _scaled(u=1.0 / KNOT, v=1.0 / KNOT), "wrong-unit", "in kn"),
    FaultKind("heading off by 20 to 60 deg", _offset_heading(20.0, 60.0), "wrong-zero", "'psi'...is off by"),
    FaultKind("heading off by 4 to 10 deg", _offset_heading(4.0, 10.0), "closure", "misalignment"),
    FaultKind("lever of 0.1 to 0.4 L", _lever, "closure", "point"),
    FaultKind("lever not turned", _unturned_lever, "closure", "not turned"),
    FaultKind("velocities late by 3 to 11 rows", _late("u", "v"), "lag", "u, v lag", ("closure", "of the velocities")),
    FaultKind("yaw rate late by 3 to 11 rows", _late("r"), "lag", "r lags"),
    FaultKind("heading late by 3 to 11 rows", _late("psi"), "lag", "heading is late", ("closure", "of the heading")),
    FaultKind("bias of u, 3 to 6 sd, 2 % at least", _biased_log, "closure", "bias of u"),
    FaultKind("current of a tenth of the speed", _current, "closure", "current"),
    FaultKind("scale of the log, 5 %", _scaled(u=1.05, v=1.05), "closure", "scale"),
    FaultKind("yaw rate stuck for a tenth", _stuck, "stuck", "'r'"),
    FaultKind("five wild headings", _wild, "outlier", "'psi'"),
    FaultKind("a jump of 50 steps", _jump, "jump"),
    FaultKind("a gap of a minute", _gap, "time-gap"),
    FaultKind("fifty rows repeated", _repeated, "repeated-rows"),
    FaultKind("yaw rate called roll rate", _mislabelled, "mislabelled", "'p'"),
    FaultKind("rudder that never moves", _still, "no-excitation"),
)
"""Those at even places serve to set thresholds, those at odd places are reported."""


def mirrored(record: Record) -> Record:
    """Return the mirror image of a record: an exact symmetry of every ship."""
    signs = dict.fromkeys(("y0", "psi", "v", "r", "delta"), -1.0)
    return with_values(record, **{symbol: k * record[symbol] for symbol, k in signs.items() if symbol in record})


def shifted(record: Record) -> Record:
    """Return the record on a clock that is ten seconds late."""
    return replace(record, time=record.time + 10.0)


UNDETECTABLE = {"mirror of all signs": mirrored, "clock shifted in all channels": shifted}
