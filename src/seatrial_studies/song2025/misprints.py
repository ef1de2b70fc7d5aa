"""The misprints of the paper, each with what the print does and what the corrected equation does."""

import math

from seatrial.core.results import Table
from seatrial_studies.song2025.audit import SupportVectorAudit
from seatrial_studies.song2025.published import MotionEquation, PublishedManoeuvre


def misprint_table(audit: SupportVectorAudit) -> Table:
    """Return the misprints, one row each."""
    turn, wild, side, thrust = audit.reversed_turn, audit.undamped_sway, audit.asymmetry, audit.thrust
    worst = {r.variant: max(r.errors.items(), key=lambda item: abs(item[1])) for r in audit.equation_14_fits}
    readings = {key: worst[key] for key in worst if "corrected" not in key}
    fresh, salt = audit.table_1_masses
    rows = [
        (
            "table 2, N_v = +0.1708 in all columns",
            f"a 20 deg order to starboard ends at {turn.yaw_rates[1]:.2f} deg/s, "
            f"{turn.completed_zigzags[1]} of 3 zigzags finish",
            f"-0.1708: {turn.yaw_rates[0]:.2f} deg/s, {turn.completed_zigzags[0]} of 3 finish",
        ),
        (
            "table 2, improved Y_vv = +0.6083",
            "motion diverges after "
            + ", ".join(f"{seconds:.0f} s ({run})" for run, seconds in wild.divergence_times.items())
            + f": beyond {wild.critical_drift:.0f} deg of drift sway is driven",
            "-0.6083: 35/35 with CC "
            + ", ".join(f"{c} {v:.4f}" for c, v in wild.corrected_accuracy[PublishedManoeuvre.ZIGZAG_35].cc.items()),
        ),
        (
            "eq. (3), alpha v in Y_P",
            f"port and starboard differ: {side.jet_yaw_rates[0]:.2f} and {side.jet_yaw_rates[1]:.2f} "
            "deg/s in 20 deg turns",
            f"alpha u: {side.corrected_yaw_rates[0]:.2f} and {side.corrected_yaw_rates[1]:.2f}",
        ),
        (
            "eq. (2), (13), Y_vv |v|, N_rr |r|",
            "a force of the dimension kg/s, the same to either side; turns diverge "
            f"after {side.hull_divergence_times[0]:.0f} s",
            "v|v|, r|r|, as eq. (14) has it",
        ),
        (
            "eq. (1), (1/m + m_x)(...)",
            "accelerations too large by " + " / ".join(f"{audit.parenthesis_factors[e]:.0e}" for e in MotionEquation),
            "1/(m + m_x)",
        ),
        *(
            (f"eq. (14), {reading}", f"least squares without noise: {name} {error:+.0f} %", "errors below 1e-10 %")
            for reading, (name, error) in readings.items()
        ),
        ("eq. (1), phi for the heading", "psi everywhere else", "psi"),
        (
            "eq. (27), the norm of the inverse is not printed",
            f"sway {audit.equation_27_readings.without_inverse:.3g}",
            f"{audit.equation_27_readings.with_inverse:.6g}, as eq. (28)",
        ),
        (
            "section 1.3.2, N_vv and N_vr insensitive; Y_rr sensitive, named twice",
            "no equation has N_vv or N_vr; Y_vr is named nowhere",
            "N_vvr and N_vrr; Y_vr for one Y_rr (our reading)",
        ),
        ("below eq. (16): eq. (16) less rho times eq. (17)", "(17) is the result", "eq. (15) less rho times eq. (16)"),
        ("eq. (24), E", "called the difference of prediction and truth", "epsilon of (21), (22), that is zeta of (20)"),
        ("table 3, labels", "sway's number below yaw's is impossible", "surge and sway exchanged"),
        ("table 4, 35/35", _impossible_error_text(audit), "a slipped decimal would explain v and r"),
        (
            "table 1, mass 5540 kg",
            f"rho C_b L B d = {salt.block:.0f} kg with rho 1025",
            f"{fresh.block:.0f} kg with rho 1000 (m' {fresh.nondimensional:.5f}; with 1025 {salt.nondimensional:.6f})",
        ),
        (
            "v_j and A_j are not printed",
            f"A_j 0.035 m^2 chosen: v_j {thrust.jet_velocity:.4f} m/s balances 0.8 m/s",
            f"thrust {thrust.thrust:.1f} N",
        ),
        (
            "the signs under other choices",
            f"{sum(h.confirms_misprints for h in audit.sign_checks)} of {len(audit.sign_checks)} choices of what "
            "is not printed confirm both",
            "densities, added masses, inertias, jet, nozzle position",
        ),
    ]
    return Table("Misprints, with evidence", ("print", "what it does", "corrected"), tuple(rows))


def _impossible_error_text(audit: SupportVectorAudit) -> str:
    (cell,) = [i for i in audit.table_4_implications if i.run is PublishedManoeuvre.ZIGZAG_35 and i.channel == "r"]
    times = (
        ""
        if math.isnan(cell.amplitude_ratio)
        else f"; with its CC the prediction would turn {cell.amplitude_ratio:.1f} times as fast"
    )
    return f"RMSE of r 0.0957 rad/s exceeds the largest |r| of the run, {cell.largest:.4f}{times}"
