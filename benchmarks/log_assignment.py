"""What `seatrial init` makes of the columns of real logs and of logs made here: right, open, missing or wrong.

`python benchmarks/log_assignment.py` prints the table; SEATRIAL_DATA is the folder of the records. A channel counts as
right with its column, unit, frame and sign; as open where the draft gives it as a commented line with both readings.
The truth was written down from the documentation of the records (README.md beside them), not from the drafts; but the
ferry's pose, said to be east-north-up there, is north-east-down: its x goes with the north of the GNSS fixes
(correlation 0.96, slope 0.95; y with the east 0.998, 1.003), and its z is -41.5 m where their altitude is 43.8 m.
"""

import os
import sys
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

sys.path.insert(0, str(Path(__file__).parents[1]))
from tests.data.read.samples import SAMPLES

from seatrial.api import draft_trial

OUTRIGHT, RIGHT_OR_OPEN = 0.85, 0.95  # shares of the channels that exist: targets

# channel -> column | unit | frame | positive; empty: the notation table's
_NMEA_0183 = {"lat": "GGA/lat|rad", "lon": "GGA/lon|rad", "sog": "RMC/speed|m/s", "cog": "RMC/course|rad",
              "psi": "HDT/heading|rad"}  # fmt: skip
_BODY = "navigation/twist_body.csv"
TRUTH: dict[str, Mapping[str, str]] = {
    "kvlcc2_hsva/HSVA_CPMC_KVLCC2_Z_20_10_S.dat": {
        "x0": "2|m", "y0": "3|m", "psi": "4|deg", "u": "5|m/s|earth", "v": "6|m/s|earth", "r": "7|deg/s",
        "delta": "9|deg||port", "n": "10|rps", "thrust": "11|N", "torque": "12|N m",
    },
    "esso_osaka/zigzag/zigzag_31-Jul-2020_13_22_52.csv": {
        "x0": "x_position_mid [m]|m", "y0": "y_position_mid [m]|m", "u": "u_velo [m/s]|m/s|body",
        "v": "vm_velo [m/s]|m/s|body", "psi": "psi_hat [rad]|rad", "r": "r_angvelo [rad/s]|rad/s",
        "n": "n_prop [rps]|rps", "delta": "delta_rudder [rad]|rad",
        "wind_speed_relative": "wind_velo_relative_mid [m/s]|m/s",
        "wind_direction_relative": "wind_dir_relative_mid [rad]|rad", "wind_speed": "wind_velo_true [m/s]|m/s",
        "wind_direction": "wind_dir_true [rad]|rad",
    },
    "kvlcc2_rolldecay/model_test_21337.csv": {
        "x0": "x|m", "y0": "y|m", "z": "z|m", "phi": "phi|rad", "theta": "theta|rad", "psi": "psi|rad",
    },
    "blueboat/fixed_00000226.csv": {
        "x0": "x_ned|m", "y0": "y_ned|m", "psi": "yaw|deg", "u": "surge|m/s|body", "v": "sway|m/s|body",
        "r": "yaw_rate|rad/s", "u_dot": "surge_dot|m/s^2|body", "v_dot": "sway_dot|m/s^2|body",
        "command_1": "thr_left|us||astern", "command_2": "thr_right|us",
    },
    "milliampere/maneuvering1": {
        **{f"alpha_{k}": "data|deg" for k in range(1, 5)}, **{f"rpm_{k}": "motor_speed|rpm" for k in range(1, 5)},
        "x0": "pose_position_x|m|earth", "y0": "pose_position_y|m|earth", "q_w": "pose_orientation_w|1|earth",
        "q_x": "pose_orientation_x|1|earth", "q_y": "pose_orientation_y|1|earth", "q_z": "pose_orientation_z|1|earth",
        "u": "twist_linear_x|m/s|body", "v": "twist_linear_y|m/s|body", "r": "twist_angular_z|rad/s",
    },
    "logs/nmea0183_202412051037.txt": _NMEA_0183,
    "logs/nmea0183_202412061726.txt": _NMEA_0183,
    "logs/nmea2000_figure8.raw": {
        "lat": "positionRapidUpdate@25/latitude|deg", "lon": "positionRapidUpdate@25/longitude|deg",
        "sog": "cogSogRapidUpdate:True@52/sog|m/s", "cog": "cogSogRapidUpdate:True@52/cog|rad",
        "psi": "attitude@52/yaw|rad", "r": "rateOfTurn@27/rate|rad/s", "phi": "attitude@27/roll|rad",
        "theta": "attitude@27/pitch|rad", "z": "heave@27/heave|m||up",
    },
    "logs/usv_sim.bag": {"x0": "position/x|m|enu", "y0": "position/y|m|enu", "psi": "position/theta|rad|enu"},
    "logs/px4_sample.ulg": {
        "x0": "vehicle_local_position/x|m", "y0": "vehicle_local_position/y|m",
        "u": "vehicle_local_position/vx|m/s|earth", "v": "vehicle_local_position/vy|m/s|earth",
        "psi": "vehicle_local_position/heading|rad", "r": "vehicle_angular_velocity/xyz[2]|rad/s",
        "p": "vehicle_angular_velocity/xyz[0]|rad/s", "voltage": "battery_status[0]/voltage_v|V",
        **{f"q_{letter}": f"vehicle_attitude/q[{k}]|1" for k, letter in enumerate("wxyz")},
    },
    "run.bin": {"u": "XKF1/VN|m/s|earth", "psi": "XKF1/Yaw|deg"},
    "run.tlog": {"u": "LOCAL_POSITION_NED/vx|m/s|earth", "psi": "ATTITUDE/yaw|rad", "r": "ATTITUDE/yawspeed|rad/s"},
    "run.mcap": {"u": "/nav/twist/twist.linear.x|m/s|body"},
    "run.xlsx": {"psi": "heading|deg"},
}  # fmt: skip


@dataclass(frozen=True)
class Row:
    """The channels of one log by what became of them."""

    log: str
    right: int
    left_open: int
    missing: tuple[str, ...]
    wrong: tuple[str, ...]

    @property
    def count(self) -> int:
        """Channels that exist."""
        return self.right + self.left_open + len(self.missing) + len(self.wrong)


def assignment(name: str, path: Path) -> Row:
    """Return what the draft of one log makes of its channels."""
    guesses = {g.symbol: g for part in draft_trial(path).guesses for g in part if g.is_used}
    right, left_open, missing, wrong = 0, 0, [], []
    for symbol, text in TRUTH[name].items():
        column, unit, frame, positive = (*text.split("|"), "", "", "")[:4]
        guess = guesses.get(symbol)
        if guess is None:
            missing.append(symbol)
        elif guess.is_open:
            left_open += 1
        elif (str(guess.source), guess.unit, guess.positive) == (column, unit, positive) and frame in ("", guess.frame):
            right += 1
        else:
            wrong.append(f"{symbol}: {guess.source} {guess.unit} {guess.frame} {guess.positive}")
    return Row(name, right, left_open, tuple(missing), tuple(wrong))


def main() -> None:
    """Print the table and the shares."""
    data, rows = Path(os.environ.get("SEATRIAL_DATA", "../shared/data")), []
    with tempfile.TemporaryDirectory() as folder:
        for name in TRUTH:
            path = data / name
            if name in SAMPLES:
                path = Path(folder) / name
                SAMPLES[name].write(path)
            if path.exists():
                rows.append(assignment(name, path))
    print(f"{'log':52s} {'right':>5s} {'open':>5s} {'missing':>7s} {'wrong':>5s}")
    for row in rows:
        notes = "; ".join([*(f"no {symbol}" for symbol in row.missing), *row.wrong])
        print(f"{row.log:52s} {row.right:5d} {row.left_open:5d} {len(row.missing):7d} {len(row.wrong):5d}  {notes}")
    count, right = sum(row.count for row in rows), sum(row.right for row in rows)
    left_open, wrong = sum(row.left_open for row in rows), sum(len(row.wrong) for row in rows)
    print(f"of {count} channels {right / count:.1%} right outright (target {OUTRIGHT:.0%}), "
          f"{(right + left_open) / count:.1%} right or open (target {RIGHT_OR_OPEN:.0%}), {wrong} wrong")  # fmt: skip


if __name__ == "__main__":
    main()
