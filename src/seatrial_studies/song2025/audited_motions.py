"""Misprints that show when the craft is simulated as printed: signs of table 2, equations (2) and (3)."""

import math
from dataclasses import dataclass

import numpy as np
import sympy as sp

from seatrial.core.equations import Model
from seatrial.core.values import Array, Record
from seatrial.physics.simulate import inputs_of
from seatrial_studies.song2025.craft_models import (
    CORRECTED,
    TRUTH,
    CoefficientSet,
    drift_angle,
    manoeuvre_record,
    reference_record,
    replay_inputs,
    simulate_manoeuvre,
    symbol,
    with_expressions,
)
from seatrial_studies.song2025.generalisation import prediction_accuracy
from seatrial_studies.song2025.published import Accuracy, PublishedManoeuvre, Table2Column, printed_coefficients

# deg, nozzle angles of the zigzags and of the turn
ZIGZAGS, TURN_ANGLE = (10, 20, 35), 20


@dataclass(frozen=True)
class ReversedTurn:
    """What the sign of N_v does, CFD column.

    Attributes:
        yaw_rates: deg/s at the end of a turn with 20 deg to starboard, N_v corrected and as printed.
        completed_zigzags: zigzags of 10, 20 and 35 deg that come to their end, corrected and as printed.
    """

    yaw_rates: tuple[float, float]
    completed_zigzags: tuple[int, int]


def reversed_turn() -> ReversedTurn:
    """Steady turn and zigzags of the CFD column with N_v negative and as printed."""
    readings = (TRUTH, CoefficientSet(Table2Column.CFD))
    rates = [
        math.degrees(_final_value(manoeuvre_record(r.craft(), f"turning-circle:{TURN_ANGLE}"), "r")) for r in readings
    ]
    finished = [sum(simulate_manoeuvre(r.craft(), f"zigzag:{a}/{a}").is_completed for a in ZIGZAGS) for r in readings]
    return ReversedTurn((rates[0], rates[1]), (finished[0], finished[1]))


@dataclass(frozen=True)
class UndampedSway:
    """What the sign of the improved column's Y_vv does, N_v corrected, on the truth's nozzle history.

    Attributes:
        divergence_times: run -> s after which the motion leaves all bounds, as printed; infinite where it does not.
        corrected_accuracy: run -> accuracy with Y_vv negative.
        critical_drift: deg beyond which Y_v + Y_vv |v|/U is positive, so that sway is driven, as printed.
        largest_drifts: run -> largest drift of the truth, deg.
    """

    divergence_times: dict[PublishedManoeuvre, float]
    corrected_accuracy: dict[PublishedManoeuvre, Accuracy]
    critical_drift: float
    largest_drifts: dict[PublishedManoeuvre, float]


def undamped_sway() -> UndampedSway:
    """Return the 20/20 and 35/35 zigzags and the 35 deg turn with the improved column's Y_vv of either sign."""
    printed, corrected = CoefficientSet(Table2Column.IMPROVED, ("N_v",)).craft(), CORRECTED[2].craft()
    references = {
        run: reference_record(run)
        for run in (PublishedManoeuvre.ZIGZAG_20, PublishedManoeuvre.ZIGZAG_35, PublishedManoeuvre.TURN_35)
    }
    values = printed_coefficients(Table2Column.IMPROVED)
    return UndampedSway(
        {run: _divergence_time(printed, record) for run, record in references.items()},
        {run: prediction_accuracy(record, replay_inputs(corrected, record)) for run, record in references.items()},
        math.degrees(math.asin(-values["Y_v"] / values["Y_vv"])),
        {run: float(np.max(np.abs(drift_angle(record)))) for run, record in references.items()},
    )


@dataclass(frozen=True)
class PortStarboardAsymmetry:
    """What alpha v in place of alpha u in Y_P, eq. (3), and |v|, |r| in Y_H, N_H, eq. (2), do to a symmetric craft.

    Attributes:
        force_asymmetry: binding -> rms of the force plus that of the mirrored state, over the force's rms, along the
            20/20 zigzag, corrected and as printed. A symmetric craft has 0, an even force 2.
        jet_yaw_rates: deg/s of yaw at the end of a 20 deg turn to starboard and to port, eq. (3) as printed.
        jet_drifts: deg of drift there.
        corrected_yaw_rates: deg/s of yaw with alpha u.
        hull_divergence_times: s after which the motion leaves all bounds on the nozzle history of these turns, eq. (2)
            as printed; infinite where it does not.
    """

    force_asymmetry: dict[str, tuple[float, float]]
    jet_yaw_rates: tuple[float, float]
    jet_drifts: tuple[float, float]
    corrected_yaw_rates: tuple[float, float]
    hull_divergence_times: tuple[float, float]


def port_starboard_asymmetry() -> PortStarboardAsymmetry:
    """Return forces at mirrored states, and turns to either side."""
    craft = TRUTH.craft()
    jet, hull = jet_as_printed(craft), hull_as_printed(craft)
    record = manoeuvre_record(craft, PublishedManoeuvre.ZIGZAG_20)
    asymmetries = {
        name: (force_asymmetry(craft, record, name), force_asymmetry(printed, record, name))
        for name, printed in (("Y_P", jet), ("Y_H", hull), ("N_H", hull))
    }
    sides = (f"turning-circle:{TURN_ANGLE}", f"turning-circle:{TURN_ANGLE}:port")
    turns, corrected = (
        [manoeuvre_record(jet, side) for side in sides],
        [manoeuvre_record(craft, side) for side in sides],
    )
    return PortStarboardAsymmetry(
        asymmetries,
        _pair([math.degrees(_final_value(turn, "r")) for turn in turns]),
        _pair([float(drift_angle(turn)[-1]) for turn in turns]),
        _pair([math.degrees(_final_value(turn, "r")) for turn in corrected]),
        _pair([_divergence_time(hull, turn) for turn in corrected]),
    )


def jet_as_printed(craft: Model) -> Model:
    """Return the side force of the jet with alpha v, eq. (3)."""
    rho, A_j, v_j, alpha, v, delta = (symbol(n) for n in ("rho", "A_j", "v_j", "alpha", "v", "delta"))
    return with_expressions(
        craft, "waterjet_jet_as_printed", {"Y_P": rho * A_j * v_j * (v_j - alpha * v) * sp.sin(delta)}
    )


def hull_as_printed(craft: Model) -> Model:
    """Y_H and N_H with |v| and |r| where v|v| and r|r| are meant, eq. (2)."""
    q, L, U, v, r_L = (symbol(n) for n in ("q", "L", "U", "v", "r_L"))
    Y_v, Y_r, Y_vv, Y_vr, Y_rr, N_v, N_r, N_rr = (symbol(n) for n in craft.parameters.free_names[3:])
    Y_H = q * (Y_v * v * U + Y_r * r_L * U + Y_vv * sp.Abs(v) + Y_rr * sp.Abs(r_L) + Y_vr * sp.Abs(v) * r_L)
    N_H = q * L * (N_v * v * U + N_r * r_L * U + N_rr * sp.Abs(r_L))
    return with_expressions(craft, "waterjet_hull_as_printed", {"Y_H": Y_H, "N_H": N_H})


def force_asymmetry(craft: Model, record: Record, binding: str) -> float:
    """Rms of F(v, r, delta) + F(-v, -r, -delta) over that of F along a record; 0 where port and starboard are alike."""
    states, inputs = record.matrix(craft.states), inputs_of(craft, record)
    turned_states = states * np.array([-1.0 if s in ("v", "r", "psi", "y0") else 1.0 for s in craft.states])
    turned_inputs = inputs * np.array([-1.0 if name == "delta" else 1.0 for name in craft.input_names])
    here, there = craft.forces(states, inputs)[binding], craft.forces(turned_states, turned_inputs)[binding]
    return _rms(here + there) / _rms(here)


def _divergence_time(craft: Model, record: Record) -> float:
    again = replay_inputs(craft, record)
    return math.inf if len(again) == len(record) else float(again.time[-1])


def _final_value(record: Record, channel: str) -> float:
    return float(record[channel][-1])


def _pair(values: list[float]) -> tuple[float, float]:
    return values[0], values[1]


def _rms(values: Array) -> float:
    return float(np.sqrt(np.mean(values**2)))
