"""Modes of an autopilot in a log: when each began, and whether a controller was on."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

from seatrial.core.values import Record
from seatrial.data.draft.survey import LogSurvey

# PX4, msg/VehicleStatus.msg: number of a navigation state -> its name
_PX4_STATES = {0: "MANUAL", 1: "ALTCTL", 2: "POSCTL", 3: "AUTO", 4: "LOITER", 5: "RTL", 10: "ACRO", 14: "OFFBOARD",
               15: "STABILIZED", 17: "TAKEOFF", 18: "LAND"}  # fmt: skip
_WITHOUT_CONTROLLER = ("MANUAL", "INITIALISING")


@dataclass(frozen=True)
class AutopilotMode:
    """A mode of the autopilot: start and stop on the clock of the log [s]."""

    name: str
    start: float
    stop: float

    @property
    def text(self) -> str:
        """What it means for an estimate."""
        if self.name in _WITHOUT_CONTROLLER:
            return f"mode {self.name}: no controller"
        return f"mode {self.name}: a controller is on, its orders follow the motion"


def autopilot_modes(surveys: Sequence[LogSurvey], record: Record) -> list[AutopilotMode]:
    """Return the modes during a record, in order, the same one after itself joined; empty: the log has none."""
    events = sorted(
        (event.time, _mode_name(event.name))
        for survey in surveys
        for event in survey.log.events
        if _mode_name(event.name)
    )
    start, end = float(record.time[0]), float(record.time[-1])
    pairs = pairwise([*events, (end, "")])
    modes = [AutopilotMode(name, max(time, start), min(stop, end)) for (time, name), (stop, _) in pairs]
    joined = list[AutopilotMode]()
    for mode in modes:
        if mode.stop - mode.start <= 0.0:
            continue
        if joined and joined[-1].name == mode.name:
            joined[-1] = replace(joined[-1], stop=mode.stop)
        else:
            joined.append(mode)
    return joined


def _mode_name(event: str) -> str:
    """The name of a mode; empty for another event."""
    kind, _, name = event.partition(" ")
    if kind == "nav_state" and name.isdecimal():
        return _PX4_STATES.get(int(name), name)
    return name if kind == "MODE" else ""
