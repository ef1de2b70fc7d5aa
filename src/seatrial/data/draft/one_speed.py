"""Roll decays at several speeds: damping depends on the speed, so that a trial holds the decays of one."""

from collections.abc import Sequence
from dataclasses import dataclass, fields
from pathlib import Path

from seatrial.data.draft.header_sizes import speed_in_header
from seatrial.data.draft.runs_of_logs import LogRun
from seatrial.data.draft.ship_estimates import StatedSize
from seatrial.data.draft.stated_columns import StatedColumns

_ALIKE = 0.05  # of a speed, by which a carriage misses it from run to run at most; chosen


@dataclass(frozen=True)
class OtherSpeed:
    """Runs that a draft leaves out: their headers state another speed [m/s] than those of its trial.

    options: of init, as stated for the draft, with which these runs are a trial of their own.
    """

    speed: float
    logs: tuple[Path, ...]
    options: tuple[str, ...]

    @property
    def reason(self) -> str:
        """Why they are left out."""
        return f"at {self.speed:g} m/s by its header: roll damping depends on the speed, fit each by itself"


def runs_by_speed(runs: Sequence[LogRun]) -> list[tuple[float, list[LogRun]]]:
    """Return the speeds [m/s] that headers state, with the runs at each; the one with most runs first, then by size.

    A run whose header states no speed counts as at rest.
    """
    groups = list[tuple[float, list[LogRun]]]()
    for run in sorted(runs, key=_speed):
        if groups and _speed(run) - groups[-1][0] <= _ALIKE * _speed(run):
            groups[-1][1].append(run)
        else:
            groups.append((_speed(run), [run]))
    in_order = [(speed, [run for run in runs if run in group]) for speed, group in groups]
    return sorted(in_order, key=lambda one: -len(one[1]))


def stated_options(size: StatedSize, stated: StatedColumns) -> tuple[str, ...]:
    """Return the options of init that state sizes and columns."""
    sizes = [(field.name, getattr(size, field.name)) for field in fields(size)]
    columns = [f"{heading}={meaning}" for heading, meaning in stated.items()]
    return (
        *(
            part
            for name, value in sizes
            if value
            for part in (f"--{name}", value if isinstance(value, str) else f"{value:g}")
        ),
        *(part for column in columns for part in ("--column", column)),
    )


def _speed(run: LogRun) -> float:
    return speed_in_header(run.sources[0]) or 0.0
