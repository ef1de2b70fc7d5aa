"""What a tuning says of a track and of a station."""

import math

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.panels import NamedCurve, curves_chart
from seatrial.core.figures.svg_text import svg
from seatrial.core.results.station import StationKeeping
from seatrial.core.results.tuning import DisturbanceSimulation, TrackKeeping, Tuning
from seatrial.core.text.numbers import exact, fixed, significant
from seatrial.core.text.words import enumeration
from seatrial.core.values import Array
from seatrial.data.folder.gains_file import channel_display_unit
from seatrial.reporting.section import Level, Picture, Section, plain_table

# Track keeping on the page of a tuning: a table of what disturbs, the corner in a sentence and as a figure.

_HALF = 1.96  # standard errors to either side of a mean: 95 % of a Gaussian
_BEFORE, _AFTER = 2.0, 5.0  # lookahead distances before and behind the corner that the figure shows; chosen
CAPTION = "The corner from above, north up. The heading order changes no faster than half the actuator keeps up."


def corner_sentence(track: TrackKeeping) -> str:
    """Return how far the craft goes beyond a corner, as identified and at worst of those drawn."""
    c = track.corner
    end = "settles" if c.is_kept else "does not settle"
    text = (
        f"At a corner of {exact(math.degrees(c.turn), 3)}°, taken {exact(c.acceptance, 3)} m before it, the craft goes "
        f"{significant(c.overshoot, 3)} m beyond the new leg and {end} on it, in "
        f"{exact(c.current, 2)} m/s of current towards the outside"
    )
    if c.draws:
        most = f"{significant(c.worst_overshoot, 3)} m at most"
        worst = "the simulation of one diverges" if math.isinf(c.worst_overshoot) else most
        known = "" if math.isnan(c.worst_overshoot) else f" ({worst})"
        text += f". Of {c.draws} ships that the fit allows {c.stable_draws} keep a track{known}"
    return f"{text}."


def track_rows(tuning: Tuning, track: TrackKeeping) -> list[tuple[str, ...]]:
    """Return of each disturbance rms: distance predicted, simulated, limited; actuator and rate but for the second."""
    factor = channel_display_unit(tuning.actuator)[0]

    def row(s: DisturbanceSimulation) -> tuple[str, ...]:
        half = significant(_HALF * s.standard_error["output"], 1)
        moved = [significant(factor * rms[key], 3)
                 for key in ("actuator", "actuator_rate") for rms in (s.predicted, s.limited)]  # fmt: skip
        free = f"{significant(s.unlimited['output'], 3)} ± {half}"
        return s.disturbance, significant(s.predicted["output"], 3), free, significant(s.limited["output"], 3), *moved

    return [row(s) for s in track.disturbances]


def corner_figure(track: TrackKeeping) -> Markup:
    """Return the track and the craft's path about the corner as SVG."""
    before, after = _BEFORE * track.lookahead, _AFTER * track.lookahead
    turn, north, east = track.corner.turn, track.corner.record["x0"], track.corner.record["y0"]
    near = (north > -before) & (np.hypot(north, east) < after)
    planned_north = np.array([-before, 0.0, after * math.cos(turn)])
    planned_east = np.array([0.0, 0.0, after * math.sin(turn)])
    curves = (NamedCurve("track", planned_east, planned_north), NamedCurve("craft", east[near], north[near]))
    return Markup(svg(curves_chart("corner", curves, "y₀, east [m]", "x₀, north [m]", is_map=True)))


# Station keeping on the page of a tuning: precision, margins, gains, thrusters, footprint, capability.

AXES = ("surge", "sway", "yaw")
FOOTPRINT_CAPTION = (
    "Where the craft is for five minutes, north up and the station in the middle, with the current from the direction "
    "in which it moves most. Dashed: the circle that holds it 95 % of the time over all directions and minutes."
)
FRONT_CAPTION = (
    "Rms error at the ends of the hull over rms thrust, by linear theory, of the bandwidths that keep the limits of Ms "
    "and dead time; the chosen ones have the least product of both."
)
CAPABILITY_CAPTION = (
    "The fastest steady current that the thrusters hold, by the direction from which it comes, bow up: by the best use "
    "of them and as the controller shares forces out. Static, without a reserve for what varies."
)
_CIRCLE = 73  # points of a closed circle, every 5 degrees; chosen


def station_section(station: StationKeeping | None) -> Section:
    """Return the chapter on station keeping; empty without one."""
    if station is None:
        return Section("")
    unit = station.force_unit
    gains = plain_table(("gain", "force", "value", "unit"), gain_rows(station), flush_left=(0, 1, 3))
    head = ("thruster", f"full astern, {unit}", f"full ahead, {unit}", "used, rms, %")
    note = (
        "τ = −K_p Rᵀe − K_i Rᵀ∫e dt − K_d v in body axes, e the pose less that ordered, v = Rᵀ de/dt behind a filter "
        f"(Fossen 2021, Algorithm 15.2), every {exact(station.sample_s, 3)} s. A generalised inverse, weighted "
        "with the thrusters’ largest thrusts, shares it out; all are reduced alike where one would exceed its limit. "
        f"Varying besides the steady current: {enumeration(station.disturbances)}. Drift forces of waves are left out."
    )
    pictures = (
        Picture(lambda: footprint_figure(station), FOOTPRINT_CAPTION),
        Picture(lambda: capability_figure(station), CAPABILITY_CAPTION),
    )
    front = (Picture(lambda: front_figure(station), FRONT_CAPTION),)
    return Section(
        "Station keeping",
        "station",
        sentences=(margin_sentence(station), capability_sentence(station)),
        note=note,
        pictures=pictures,
        parts=(
            Section("Error over thrust", pictures=front, level=Level.PAGE, is_folded=True),
            Section("Gains of station keeping", table=gains, level=Level.DETAIL, is_folded=True),
            Section("Thrusters", table=plain_table(head, thruster_rows(station)), level=Level.DETAIL, is_folded=True),
        ),
    )


def precision_sentence(station: StationKeeping) -> str:
    """Return how well the place is kept by the nonlinear craft, beside linear theory, and by craft of the fit."""
    t, expected = station.trial, station.predicted
    text = (
        f"In {exact(station.current, 3)} m/s of current from {len(t.directions)} directions the craft stays within "
        f"{significant(t.radius, 3)} m 95 % of the time ({significant(t.position, 3)} m rms, "
        f"{significant(expected.position, 3)} m by linear theory). The heading is kept to "
        f"{significant(math.degrees(t.heading), 2)}° rms ({significant(math.degrees(expected.heading), 2)}°), with "
        f"{significant(100.0 * t.thrust, 2)} % of full thrust (rms)"
    )
    if t.draws:
        known = f" ({significant(t.worst_radius, 3)} m at most)" if t.stable_draws else ""
        text += f". Of {t.draws} craft that the fit allows {t.stable_draws} keep the place{known}"
    return f"{text}."


def margin_sentence(station: StationKeeping) -> str:
    """Return bandwidths and margins of the three loops."""
    m = station.margins
    delay = f"{significant(m.delay_margin, 2)} s" if math.isfinite(m.delay_margin) else "unlimited"
    return (
        f"Natural frequencies: {significant(station.position_bandwidth, 2)} rad/s of position, "
        f"{significant(station.heading_bandwidth, 2)} rad/s of heading. Ms of surge, sway and yaw "
        f"{fixed(m.surge, 2)}, {fixed(m.sway, 2)} and {fixed(m.yaw, 2)}, of all together {fixed(m.joint, 2)}; delay "
        f"margin {delay} beyond {significant(station.dead_time, 2)} s of dead time."
    )


def capability_sentence(station: StationKeeping) -> str:
    """Return the slowest and the fastest of the largest currents, and what limits the former."""
    c = station.capability
    worst, best = int(np.argmin(c.current)), int(np.argmax(c.current))
    return (
        f"The thrusters hold a steady current of {significant(c.current[worst], 3)} m/s from any direction; shared out "
        f"as the controller does, {significant(float(c.current_shared_out.min()), 3)} m/s. They hold least from "
        f"{_degrees(c.direction[worst])}° off the bow, where {_limiting(c.limiting[worst])}, and "
        f"{significant(c.current[best], 3)} m/s from {_degrees(c.direction[best])}°."
    )


def gain_rows(station: StationKeeping) -> list[tuple[str, ...]]:
    """Return a row for each gain that is not zero: name, force in an axis from what in which, value, unit."""
    rows = []
    for name, meaning in (("KP", "error"), ("KI", "integral"), ("KD", "velocity")):
        matrix, units = getattr(station, name), station.gain_units[name]
        rows += [
            (f"{name[0]}_{name[1].lower()}", f"in {AXES[i]}, from the {meaning} in {AXES[j]}",
             significant(matrix[i][j], 4), units[i][j])
            for i in range(3) for j in range(3) if matrix[i][j]
        ]  # fmt: skip
    return rows


def thruster_rows(station: StationKeeping) -> list[tuple[str, ...]]:
    """Return a row for each thruster: name, thrust full astern and ahead, rms used in per cent."""
    return [
        (one.name, significant(one.thrust[0], 3), significant(one.thrust[-1], 3), significant(100.0 * used, 2))
        for one, used in zip(station.thrusters, station.trial.used, strict=True)
    ]


def footprint_figure(station: StationKeeping) -> Markup:
    """Return where the craft is on station as SVG."""
    record, angles = station.trial.record, np.linspace(0.0, 2.0 * math.pi, _CIRCLE)
    radius = station.trial.radius
    curves = (
        NamedCurve("craft", record["y0"], record["x0"]),
        NamedCurve("95 % of the time", radius * np.sin(angles), radius * np.cos(angles)),
    )
    return Markup(svg(curves_chart("footprint", curves, "y₀, east [m]", "x₀, north [m]", is_map=True)))


def capability_figure(station: StationKeeping) -> Markup:
    """Return the largest current by direction as SVG, bow up."""
    c = station.capability
    curves = (
        _polar("thrusters", c.direction, c.current),
        _polar("shared out by the controller", c.direction, c.current_shared_out),
    )
    return Markup(svg(curves_chart("capability", curves, "from starboard [m/s]", "from ahead [m/s]", is_map=True)))


def front_figure(station: StationKeeping) -> Markup:
    """Return error over thrust of the front as SVG, the chosen bandwidths marked."""
    front = station.front
    if len(front.error) < 2:
        return Markup()
    best = int(np.argmin(front.error * front.thrust))
    curves = (
        NamedCurve("front", 100.0 * front.thrust, front.error),
        NamedCurve("chosen", 100.0 * np.repeat(front.thrust[best], 2), np.array([0.0, front.error[best]])),
    )
    return Markup(svg(curves_chart("station front", curves, "rms thrust that varies [%]", "rms error [m]")))


def _polar(name: str, direction: Array, size: Array) -> NamedCurve:
    a, r = np.append(direction, direction[0]), np.append(size, size[0])
    return NamedCurve(name, r * np.sin(a), r * np.cos(a))


def _degrees(angle: float) -> str:
    return f"{math.degrees(angle):.0f}"


def _limiting(names: tuple[str, ...]) -> str:
    if not names:
        return "none is at its limit"
    return f"{enumeration(names)} {'is at its limit' if len(names) == 1 else 'are at their limits'}"
