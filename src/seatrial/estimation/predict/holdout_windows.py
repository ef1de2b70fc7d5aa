"""Windows of held-out runs simulated open loop: position and heading errors from an initial state estimated in each."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.estimation.predict.start_states import start_states
from seatrial.estimation.predict.windows import Windows, simulate_windows
from seatrial.estimation.problem.output_error import OutputError

_TRACK = ("x0", "y0", "psi")


@dataclass(frozen=True)
class HoldoutProtocol:
    """How held-out runs are judged.

    Attributes:
        window_s: length of the windows; they follow one another from the first sample, the remainder is dropped.
        initial_s: the initial state of a window is estimated from its first seconds; 0 takes the first sample as it is.
        max_windows: number of windows of each run that count, from the first on; None: all.
    """

    window_s: float = 50.0
    initial_s: float = 5.0
    max_windows: int | None = None


@dataclass(frozen=True)
class WindowError:
    """Root-mean-square error of one window: position in m, heading in degrees; `start` in s."""

    run: str
    label: str
    fold: int
    start: float
    position_m: float
    heading_deg: float


def split_windows(record: Record, protocol: HoldoutProtocol) -> list[Record]:
    """Return the record's windows, one after another; empty where it is shorter than one."""
    return Windows.cut([record], protocol.window_s, protocol.max_windows).pieces


def window_errors(
    template: OutputError,
    model: Model,
    records: Sequence[Record],
    nuisances: Sequence[Array],
    labels: Sequence[str],
    protocol: HoldoutProtocol,
    fold: int = 0,
) -> list[WindowError]:
    """Return errors of all windows of `records`, simulated open loop with `nuisances`, shape (kinds,) a record.

    A window in which position or heading is never measured has no error and is left out.
    template: the problem whose outputs, noise and nuisances are used to estimate initial states.

    Raises:
        InputError: a record lacks position or heading, no record holds a window, or a simulation diverges.
    """
    _require_track(records)
    windows, of_runs = Windows.cut(records, protocol.window_s, protocol.max_windows), np.stack(nuisances)
    if not len(windows):
        raise InputError(f"no run is as long as a window of {protocol.window_s:g} s; give shorter windows")
    states = start_states(template, model, windows, of_runs, protocol.initial_s).values
    place = [model.observables.index(model.observable_of(channel)) for channel in _TRACK]
    simulated = simulate_windows(template, model, windows, of_runs, states)[:, :, place]
    errors = []
    for piece, index, track in zip(windows.pieces, windows.run, simulated, strict=True):
        if not np.all(np.isfinite(track)):
            raise InputError(
                f"the simulation of run '{piece.name}' from {piece.time[0]:g} s diverges; check the bounds"
            )
        error = track - np.stack([piece.measured(channel) for channel in _TRACK], axis=1)
        if not np.all(np.any(np.isfinite(error), axis=0)):
            continue
        position = float(np.sqrt(np.nanmean(error[:, 0] ** 2) + np.nanmean(error[:, 1] ** 2)))
        heading = float(np.degrees(np.sqrt(np.nanmean(error[:, 2] ** 2))))
        errors.append(WindowError(piece.name, labels[int(index)], fold, float(piece.time[0]), position, heading))
    return errors


def _require_track(records: Sequence[Record]) -> None:
    for record in records:
        for channel in _TRACK:
            if channel not in record:
                raise InputError(
                    f"record '{record.name}' has no '{channel}'; windows are judged by position and heading"
                )
