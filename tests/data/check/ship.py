"""Kinematic test ships: exact tracks without any model, and the mirror image of a record."""

from dataclasses import replace

import numpy as np

from seatrial.core.values import Array, Channel, Record

MIRRORED = ("y0", "psi", "v", "r", "delta", "phi", "p")


def integral(rate: Array, dt: float) -> Array:
    return np.concatenate([[0.0], np.cumsum(0.5 * (rate[1:] + rate[:-1])) * dt])


def zigzag(amplitude: float = 0.5, dt: float = 0.1, count: int = 3000, noise: float = 0.0, seed: int = 1) -> Record:
    """A ship that follows dr/dt = -.1 r + .02 delta at 1.2 m/s, steered by a slow square wave; midship, SI."""
    rng = np.random.default_rng(seed)
    t = dt * np.arange(count)
    delta = amplitude * np.sign(np.sin(2 * np.pi * t / 60.0 + 0.3))
    r = np.empty(count)
    r[0] = 0.0
    for k in range(count - 1):
        r[k + 1] = r[k] + dt * (-0.1 * r[k] + 0.02 * delta[k])
    psi = integral(r, dt)
    u, v = 1.2 - 2.0 * r**2, -0.8 * r
    c, s = np.cos(psi), np.sin(psi)
    x, y = integral(u * c - v * s, dt), integral(u * s + v * c, dt)
    values = {"x0": x, "y0": y, "psi": psi, "u": u, "v": v, "r": r, "delta": delta}
    sigma = {"x0": 0.02, "y0": 0.02, "psi": 2e-3, "u": 0.01, "v": 0.01, "r": 1e-3, "delta": 0.0}
    noisy = {k: a + noise * sigma[k] * rng.standard_normal(count) for k, a in values.items()}
    return Record.from_arrays("zigzag", t, noisy)


def mirrored(record: Record) -> Record:
    """Port and starboard exchanged: the same ship seen in a mirror."""
    channels = {s: c.with_values(-c.values) if s in MIRRORED else c for s, c in record.channels.items()}
    return replace(record, channels=channels)


def with_values(record: Record, **values: Array) -> Record:
    channels = {s: record.channel(s).with_values(a) for s, a in values.items()}
    return replace(record, channels={**record.channels, **channels})


def with_declaration(record: Record, symbol: str, **changes: str | float) -> Record:
    channel: Channel = replace(record.channel(symbol), **changes)  # type: ignore[arg-type]
    return replace(record, channels={**record.channels, symbol: channel})


def in_earth_axes(record: Record) -> Record:
    """u, v stored and declared earth-fixed."""
    c, s = np.cos(record["psi"]), np.sin(record["psi"])
    u, v = record["u"], record["v"]
    turned = with_values(record, u=u * c - v * s, v=u * s + v * c)
    return with_declaration(
        with_declaration(turned, "u", frame="earth", positive="north"), "v", frame="earth", positive="east"
    )
