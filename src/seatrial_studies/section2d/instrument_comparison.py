"""Instruments against one another: channels that never move, delay, gain and clock between two of the same motion."""

from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from seatrial.core.values import Array, Finding, Record, Severity

MIN_CHANGES = 3


@dataclass(frozen=True)
class InstrumentComparison:
    """One instrument against another in a steady regular wave.

    Attributes:
        delay: s by which the first lags the second at the window's middle, modulo the wave period, within half of it.
        clock_drift: s per s; a clock that runs slow by 1 % drifts by 0.01.
        gain: amplitude of the second over that of the first, median over windows.
        delay_scatter: s, scatter of the delay about its line.
    """

    delay: float
    clock_drift: float
    gain: float
    delay_scatter: float


def dead_channel_findings(record: Record, symbols: Iterable[str] | None = None) -> tuple[Finding, ...]:
    """Channels that hold (nearly) one value throughout while the record lasts; one finding each."""
    made = []
    for symbol in symbols if symbols is not None else record.channels:
        values = record[symbol]
        changes = int(np.count_nonzero(np.diff(values)))
        if changes < MIN_CHANGES:
            made.append(
                Finding(
                    Severity.ERROR,
                    "dead-channel",
                    f"{record.name}: channel '{symbol}' ({record.channel(symbol).label}) does not move",
                    f"{changes} changes in {len(record)} samples",
                    "leave the channel of this record out",
                )
            )
    return tuple(made)


def compare_instruments(
    time: Array, first: Array, second: Array, omega: float, periods: float = 2.0
) -> InstrumentComparison:
    """Delay, drift and gain between two channels of one motion from their phases in sliding windows.

    Args:
        time, first, second: (n,), a stretch of regular waves in which both move.
        omega: rad/s.
        periods: length of a window.
    """
    dt = float(time[1] - time[0])
    length = max(8, round(periods * 2.0 * np.pi / omega / dt))
    turning = np.exp(-1j * omega * time)
    kernel = np.hanning(length + 2)[1:-1]
    one, two = (np.convolve((x - x.mean()) * turning, kernel / kernel.sum(), "valid") for x in (first, second))
    middle = time[length // 2 : length // 2 + len(one)]
    phase = np.unwrap(np.angle(two * one.conj()))
    delays = phase / omega
    centre = 0.5 * (time[0] + time[-1])
    slope, offset = np.polyfit(middle - centre, delays, 1) if len(middle) > 2 else (0.0, float(delays.mean()))
    period = 2.0 * np.pi / omega
    left = delays - offset - slope * (middle - centre)
    return InstrumentComparison(
        float((offset + 0.5 * period) % period - 0.5 * period),
        float(slope),
        float(np.median(np.abs(two) / np.maximum(np.abs(one), 1e-300))),
        float(np.std(left)),
    )
