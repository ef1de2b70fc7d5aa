"""A track kept by guidance and controller written from gains.toml alone: is the distance from it that of the page?

The simulator is this file's own: T r' + r = K delta on a plane, a current that carries the craft, line of sight once a
sample as gains.toml states it, the controller of `controllers_at_sea` behind it.
"""

import math
import tomllib
from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np
from measure import Line, at_most
from second_simulator import (
    DEGREE,
    OVERSHOOT,
    QUICK,
    RMS,
    OwnActuator,
    OwnController,
    gauss_markov,
    lag_of,
    nomoto_step,
    print_lines,
    tuning_of,
)

from seatrial.control.front import Effort
from seatrial.core.values import Array, Ship
from seatrial.data.folder.gains_file import gains_toml
from seatrial.data.folder.model_file import ModelFile
from seatrial.physics.models import model_named

CYCLES = 1000.0  # time constants of the current, of the simulator's own realisation: 2 % of its rms
SHORT = 0.05  # step of the simulator over the time constant and five times the dead time, at most
BEFORE, AFTER = 8.0, 20.0  # lookahead distances before and behind a corner


@dataclass(frozen=True)
class TrackCraft:
    """A craft with T r' + r = K delta at U [m/s]; limits in deg, times in s, the current across in m/s and rad/s."""

    name: str
    K: float
    T: float
    U: float
    length: float
    limit: float
    rate: float
    dead_time: float
    gear: float
    sample_s: float
    current: float
    bandwidth: float
    time_constant: float

    def parts(self, sample_s: float) -> int:
        """Return how many steps of the simulator make a sample."""
        return math.ceil(sample_s / (SHORT * min(self.T, 5.0 * self.dead_time)))

    @property
    def model(self) -> ModelFile:
        """The craft as an identified model."""
        model = model_named("nomoto").with_values({"K": self.K, "T": self.T, "U": self.U})
        return ModelFile(model, ship=Ship(self.name, {"L": self.length}))

    def loop_file(self) -> str:
        """Return the loop file."""
        return f"""
name = "{self.name}"
[plant]
model = "model.toml"
[controller]
kind = "pid"
sample_s = {self.sample_s}
[actuator]
limit = {{ value = {self.limit}, unit = "deg" }}
rate = {{ value = {self.rate}, unit = "deg/s" }}
dead_time = {self.dead_time}
servo = [{{ lag = {self.gear} }}]
[[slow_disturbances]]
rms = {{ value = 1, unit = "deg" }}
bandwidth = 0.05
[demand]
change = {{ value = 20, unit = "deg" }}
time_constant = {self.time_constant}
[track]
current = {self.current}
bandwidth = {self.bandwidth}
"""


TRACKS = (
    TrackCraft("RIB on a track", 1.0, 0.6, 6.0, 8.0, 30.0, 20.0, 0.2, 0.1, 0.1, 0.5, 0.02, 1.0),
    TrackCraft("patrol boat on a track", 0.16, 4.0, 9.0, 30.0, 35.0, 4.0, 0.5, 0.5, 0.2, 0.5, 0.01, 5.0),
    TrackCraft("ship of 100 m on a track", 0.08, 10.0, 7.0, 100.0, 35.0, 3.0, 0.5, 1.0, 0.5, 0.4, 0.005, 15.0),
)


@dataclass(frozen=True)
class Sailed:
    """Distance from the leg followed [m] and rudder [rad] at every step, and the first step on the new leg."""

    error: Array
    rudder: Array
    new_leg: int


def sail(
    craft: TrackCraft, text: str, duration: float, current: Callable[[int], tuple[float, float]], corner: float,
    turn: float, acceptance: float,
) -> Sailed:  # fmt: skip
    """Return a run from a leg to the north to one turned by `turn` at `corner` [m]; current: north, east at a step."""
    own, law = OwnController(text), tomllib.loads(text)["track"]
    parts = craft.parts(own.T)
    dt, fastest = own.T / parts, law["order_rate_deg_per_s"] * DEGREE * own.T
    Delta, sigma = law["lookahead_m"], law.get("integral_gain_m_per_s", 0.0)
    north = east = psi = r = order = ordered = q = 0.0
    rudder = OwnActuator(dt, craft.dead_time, lag_of(craft.gear, dt), craft.limit * DEGREE, craft.rate * DEGREE)
    turned, leg, first = nomoto_step(craft.K, craft.T, dt), 0, math.ceil(duration / own.T) * parts
    errors, moved = np.empty(first), np.empty(first)
    for i in range(len(errors)):
        if not leg and corner - north < acceptance:
            leg, first = 1, i
        chi = turn if leg else 0.0
        e = -(north - corner) * math.sin(chi) + east * math.cos(chi) if leg else east
        errors[i], moved[i] = e, rudder.angle
        if i % parts == 0:
            total = e + sigma * q
            q += own.T * Delta * e / (total * total + Delta * Delta)
            ordered += min(max(chi - math.atan(total / Delta) - ordered, -fastest), fastest)
            order = own.order(ordered - psi, 0.0)
        before = psi
        psi, r = turned(psi, r, rudder.move(order))
        middle = 0.5 * (before + psi)
        set_north, set_east = current(i)
        north += dt * (craft.U * math.cos(middle) + set_north)
        east += dt * (craft.U * math.sin(middle) + set_east)
    return Sailed(errors, moved, first)


def lines_of(crafts: Sequence[TrackCraft], effort: Effort | None = None) -> list[Line]:
    """Return the lines of some crafts: rms in the current, and the corner."""
    lines = []
    for craft in crafts:
        _, tuning = tuning_of(craft.loop_file(), craft.model, effort)
        text, track = gains_toml(tuning), tuning.track
        assert track is not None
        page = track.disturbances[0].limited
        T, duration = tomllib.loads(text)["discrete"]["sample_s"], CYCLES / craft.bandwidth
        dt = T / craft.parts(T)
        met = gauss_markov(craft.current, craft.bandwidth, dt, round(duration / dt) + 1000, np.random.default_rng(47))
        run = sail(craft, text, duration, lambda i, met=met: (0.0, met[i]), math.inf, 0.0, 0.0)
        counted = slice(round(20.0 / craft.bandwidth / dt), None)
        corner, Delta = track.corner, track.lookahead
        set_to = (craft.current * math.sin(corner.turn), -craft.current * math.cos(corner.turn))
        turned = sail(craft, text, (BEFORE + AFTER) * Delta / craft.U, lambda _, c=set_to: c, BEFORE * Delta,
                      corner.turn, corner.acceptance)  # fmt: skip
        beyond = max(0.0, float(np.max(-turned.error[turned.new_leg :])))
        last = turned.error[3 * len(turned.error) // 4 :]
        kept = bool(np.abs(last).max() <= corner.acceptance)
        ratios = (page["output"] / float(np.std(run.error[counted])),
                  page["actuator"] / float(np.std(run.rudder[counted])))  # fmt: skip
        lines += [
            at_most(f"{craft.name}: distance rms in the current {page['output']:.2f} m, page over simulator",
                    abs(100.0 * (ratios[0] - 1.0)), "%", RMS),
            at_most(f"{craft.name}: rudder rms in the current, page over simulator", abs(100.0 * (ratios[1] - 1.0)),
                    "%", RMS),
            at_most(f"{craft.name}: beyond the corner {corner.overshoot:.1f} m, page less simulator, of the acceptance",
                    100.0 * abs(corner.overshoot - beyond) / corner.acceptance, "points", OVERSHOOT),
            at_most(f"{craft.name}: kept by the page, not by the simulator, or the other way",
                    float(corner.is_kept != kept), "", 0.0),
        ]  # fmt: skip
    return lines


def run() -> list[Line]:
    """Return the lines of the patrol boat, a sample of all."""
    return lines_of(TRACKS[1:2], QUICK)


if __name__ == "__main__":
    for each in TRACKS:
        print_lines(lines_of([each], QUICK))
