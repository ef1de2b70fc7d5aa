"""What the training runs do not show, in plain words, each with the manoeuvre that would show it; nothing is fitted."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from seatrial.core.results import Fit
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Record
from seatrial.core.values.notation import channel_meaning, channel_unit, unit_text
from seatrial.physics.manoeuvres import REACH_PERCENTILE, initial_speed, ordered_degrees, steered_orders, to_starboard
from seatrial.physics.models.thruster_layout import ThrusterLayout, layout_of, steering_angles, with_steering_order
from seatrial.reporting.section import KeyFact
from seatrial.reporting.verdict import LEAST_RUDDER, extrapolation_limit

# share of the other side's rudder angle below which a side was not used; chosen
ONE_SIDED = 0.1
# share of their mean by which speeds at the start of runs differ that count as one; chosen
ONE_SPEED = 0.1
# share of their mean by which rates of a propeller differ that count as one; chosen
ONE_RATE = 0.05
# deg, of most ships' rudders (SOLAS II-1/29), and the share of it from which on it was reached; chosen
FULL_RUDDER_DEG, REACHED = 35.0, 0.9
# of the speed or rate of the runs: another one that shows how forces change with it; chosen
ANOTHER = 0.75
# share of full command from which on it was reached, and from which on a thruster drives; chosen
FULL_COMMAND, LEAST_COMMAND = 0.9, 0.1
# deg: a deck edge immerses at about that; factor of the largest roll that shows more of the damping; chosen
LARGEST_RELEASE_DEG, LARGER = 35.0, 2.0
_PROPULSION = ("n", "v_j")
_OTHER = {"port": "starboard", "starboard": "port"}


_RUDDER, _TURNED = ("rudder", "ship"), ("steering angle", "craft")
"""What steers and what is steered, in a sentence."""


@dataclass(frozen=True)
class RecordGap:
    """Something that the training runs do not show: in short, in a sentence, and the options of `simulate` that do."""

    name: str
    text: str
    options: str

    @property
    def command(self) -> str:
        """The option of `seatrial simulate`."""
        return f"--manoeuvre {self.options}"


def record_gaps(fit: Fit) -> tuple[RecordGap, ...]:
    """Return what the training runs do not show of a craft that is steered, driven by thrusters, or rolls out."""
    runs = [p.measured for p in fit.predictions if p.role == "training"]
    if not runs:
        return ()
    if fit.model.has_thrusters:
        return tuple(gaps_of_thrusters(runs, layout_of(fit.model)))
    if fit.model.has_rudder:
        return tuple(_of_steering(fit, [r for r in runs if "delta" in r]))
    return tuple(gaps_of_rolling(runs)) if fit.roll is not None else ()


def gap_facts(fit: Fit) -> tuple[KeyFact, ...]:
    """Return the row that names them, first beyond what the model extrapolates; no row where there is none."""
    limit = extrapolation_limit(fit)
    subject = limit.partition(" beyond ")[0]
    names = [gap.name for gap in record_gaps(fit) if not (subject and gap.name.startswith(f"{subject} beyond "))]
    names = [limit, *names] if limit else names
    if not names:
        return ()
    return (KeyFact("Not in the training runs", "; ".join(names), "identifiability" if fit.identifiability else ""),)


def _of_steering(fit: Fit, runs: Sequence[Record]) -> Iterator[RecordGap]:
    if not runs:
        return
    yield from _of_angles(runs, _RUDDER)
    zigzag = _usual_zigzag(runs)
    speeds = [speed for r in runs if math.isfinite(speed := initial_speed(r)) and speed > 0.0]
    if fit.model.has_speed and speeds and np.ptp(speeds) <= ONE_SPEED * np.mean(speeds):
        speed = float(np.mean(speeds))
        begin = {1: "The only run begins", 2: "Both runs begin"}.get(len(runs), f"All {len(runs)} runs begin")
        yield RecordGap(
            f"approach speeds other than {significant(speed, 2)} m/s", f"{begin} at {significant(speed, 2)} m/s: how "
            "forces change with speed shows only as far as turning slows the ship.",
            f"{zigzag} --speed {significant(ANOTHER * speed, 2)}",
        )  # fmt: skip
    for name in _PROPULSION:
        if name in fit.model.input_names:
            yield from _of_propulsion(name, [r for r in runs if name in r], zigzag)


def _of_angles(runs: Sequence[Record], words: tuple[str, str]) -> Iterator[RecordGap]:
    """Yield a side to which the rudder, or what turns instead, was not put over, and larger angles than in the runs."""
    angle, craft = words
    angles = np.concatenate([to_starboard(r, "delta") for r in runs]) if runs else np.zeros(1)
    port, starboard = (_reach(side) for side in (-angles, angles))
    over = math.degrees(max(port, starboard))
    if max(port, starboard) < LEAST_RUDDER:
        return
    if other := _unused_side(port, starboard):
        yield RecordGap(
            f"turns to {other}",
            f"The {angle} went to {_OTHER[other]} only: whether the {craft} turns alike to both sides is "
            "assumed.",
            f"turning-circle:{over:.0f}{':port' if other == 'port' else ''}",
        )  # fmt: skip
    if over < REACHED * FULL_RUDDER_DEG:
        yield RecordGap(
            f"{angle} beyond {over:.0f}°", f"The {angle} went to {over:.0f}° at most: forces beyond that, "
            "as in a hard turn, are extrapolated.", f"turning-circle:{FULL_RUDDER_DEG:.0f}",
        )  # fmt: skip


def _of_propulsion(name: str, runs: Sequence[Record], zigzag: str) -> Iterator[RecordGap]:
    """One rate of the propeller or one speed of the jet, within `ONE_RATE`."""
    values = np.concatenate([r[name][np.isfinite(r[name])] for r in runs]) if runs else np.zeros(0)
    centre = float(np.median(values)) if len(values) else 0.0
    spread = float(np.ptp(np.percentile(values, [100.0 - REACH_PERCENTILE, REACH_PERCENTILE]))) if centre else math.inf
    if spread > ONE_RATE * abs(centre):
        return
    value = f"{significant(centre, 3)} {unit_text(channel_unit(name))}".strip()
    yield RecordGap(
        "thrust apart from resistance", f"The {channel_meaning(name)} was {value} throughout: the runs show the "
        "balance of thrust and resistance there, and neither by itself.",
        f"{zigzag} --set {name}={float(f'{ANOTHER * centre:.2g}'):g}",
    )  # fmt: skip


def gaps_of_thrusters(runs: Sequence[Record], layout: ThrusterLayout) -> Iterator[RecordGap]:
    """Yield what runs do not show of a craft with thrusters: a side, larger angles, full command, orders astern."""
    from seatrial.physics.models.thrust_orders import work_shares

    if steering_angles(layout):
        ordered = [with_steering_order(r, layout) for r in runs]
        yield from _of_angles([r for r in ordered if "delta" in r], _TURNED)
    elif any(share.yaw for share in work_shares(layout)):
        yield from _of_spins(runs)
    yield from _of_commands(runs, layout)


def _of_spins(runs: Sequence[Record]) -> Iterator[RecordGap]:
    """Yield a side to which a craft that is steered by difference of thrust did not turn."""
    rates = [to_starboard(r, "r") if "r" in r else np.gradient(to_starboard(r, "psi"), r.time)
             for r in runs if "r" in r or "psi" in r]  # fmt: skip
    port, starboard = (_reach(np.concatenate([sign * rate for rate in rates])) if rates else 0.0 for sign in (-1, 1))
    if other := _unused_side(port, starboard):
        yield RecordGap(
            f"turns to {other}",
            f"The craft turned to {_OTHER[other]} only: whether it turns alike to both sides is assumed.",
            f"spin:50{':port' if other == 'port' else ''}",
        )  # fmt: skip


def _of_commands(runs: Sequence[Record], layout: ThrusterLayout) -> Iterator[RecordGap]:
    orders = [
        (r[t.command.channel] - t.command.zero) / t.command.span
        for t in layout.thrusters for r in runs if t.command.channel in r
    ]  # fmt: skip
    if not orders:
        return
    ahead, astern = (_reach(sign * np.concatenate(orders)) for sign in (1.0, -1.0))
    if LEAST_COMMAND <= ahead < FULL_COMMAND:
        yield RecordGap(
            f"orders beyond {100.0 * ahead:.0f} % ahead", f"No thruster had more than {100.0 * ahead:.0f} % of full "
            "command ahead: thrust and top speed at full command are extrapolated.", "straight:100",
        )  # fmt: skip
    if astern < LEAST_COMMAND:
        yield RecordGap(
            "orders astern", "No thruster was driven astern: stopping and thrust astern are assumed.", "stop:50"
        )


def gaps_of_rolling(runs: Sequence[Record]) -> Iterator[RecordGap]:
    """Yield the roll angles beyond those of the runs, where a ship can be heeled so far."""
    rolls = [float(np.nanmax(np.abs(r["phi"]))) for r in runs if "phi" in r and np.isfinite(r["phi"]).any()]
    largest = math.degrees(max(rolls, default=0.0))
    if 0.0 < LARGER * largest <= LARGEST_RELEASE_DEG:
        yield RecordGap(
            f"roll beyond {largest:.0f}°", f"The ship rolled to {largest:.0f}° at most: how its damping goes on to "
            "grow with the angle is extrapolated.", f"release:{LARGER * largest:.0f}",
        )  # fmt: skip


def _unused_side(port: float, starboard: float) -> str:
    """The side to which it went by less than `ONE_SIDED` of the other; empty: to both."""
    if min(port, starboard) >= ONE_SIDED * max(port, starboard):
        return ""
    return "port" if starboard > port else "starboard"


def _reach(values: Array) -> float:
    """How far the values go to the positive side, but for a few of them."""
    return float(np.nanpercentile(np.maximum(values, 0.0), REACH_PERCENTILE)) if np.isfinite(values).any() else 0.0


def _usual_zigzag(runs: Sequence[Record]) -> str:
    """The zigzag of the runs with the most rudder, by rudder and heading; 20/20 where there was none."""
    orders = [o for r in runs if (o := steered_orders(r)) is not None and not o.is_turn]
    largest = max(orders, key=lambda o: o.rudder, default=None)
    if largest is None:
        return "zigzag:20/20"
    return f"zigzag:{ordered_degrees(largest.rudder):.0f}/{ordered_degrees(largest.heading):.0f}"
