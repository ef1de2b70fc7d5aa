"""The same KVLCC2 manoeuvres with shipmmg, in one run: speed as a ratio, trajectories held against its tolerance."""

import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
import shipmmg_equations as peer
from measure import Line, at_least, at_most, fastest

from seatrial.numerics.kernels.feedback import steer
from seatrial.physics.manoeuvres.programme import Steering, programme, rudder_angles
from seatrial.physics.simulate.batch import SegmentBatch

HERE = Path(__file__).parent
DURATION, DT, SLEW = 100.0, 0.1, np.radians(15.0)  # s, s, rad/s: KVLCC2 model rudder, 2.32 deg/s full scale
SAMPLES = round(DURATION / DT) + 1
COARSE = 5  # samples a step in a steady turn, where shipmmg's adaptive steps are long too


def peers_python(folder: Path, packages: str = "peers.txt") -> Path:
    """A Python with the peers' packages, made in `folder`."""
    subprocess.run([sys.executable, "-m", "venv", folder], check=True)
    python = folder / ("Scripts" if os.name == "nt" else "bin") / "python"
    install = [python, "-m", "pip", "install", "--quiet", "--disable-pip-version-check", "-r", HERE / packages]
    subprocess.run(install, check=True, stderr=subprocess.DEVNULL)
    return python


class OwnIntegration:
    """The peer's equations in this package's integrator."""

    def __init__(self) -> None:
        self.model = peer.model()
        self.start = np.array([peer.SPEED, 0.0, 0.0, 0.0, 0.0, 0.0])
        self.p = self.model.parameters.values

    def replay(self, rudder: np.ndarray, stride: int = 1) -> np.ndarray:
        """States under a recorded rudder, one Runge-Kutta step every `stride` samples."""
        inputs = np.stack([rudder[::stride], np.full(len(rudder[::stride]), peer.RATE)], axis=1)
        batch = SegmentBatch(self.model, inputs, np.array([0, len(inputs)]), stride * DT, self.model.states)
        return batch.simulate(0, 1, self.start[None], self.p[None], np.empty((1, 0)))[0]

    def zigzag(self) -> np.ndarray:
        """Rudder angles (samples,) of a 20/20 zigzag steered in the loop."""
        plan = programme("zigzag:20/20")
        memory = plan.memory(Steering(5, 2, 0, 1.0, SLEW, DT, 0.0, 7.0 / peer.SPEED))
        states, inputs = np.empty((SAMPLES, 6)), np.empty((SAMPLES, 2))
        begin = np.array([0.0, peer.RATE])
        steer(self.model.compiled.rates, plan.helmsman, self.start, begin, self.p, memory, DT, states, inputs)
        return rudder_angles(inputs[:, 0])


def _distance(a: np.ndarray, b: np.ndarray) -> float:
    return float(np.hypot(*(a - b)[:, 3:5].T).max())


def run() -> list[Line]:
    """Ratios of time and distances of tracks."""
    ours = OwnIntegration()
    turn, zigzag = np.full(SAMPLES, np.radians(35.0)), ours.zigzag()
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            python = peers_python(folder / "peers")
        except subprocess.CalledProcessError:
            print("  left out: the peer's packages could not be installed")
            return []
        np.savez(
            folder / "task.npz", time=np.arange(SAMPLES) * DT, n=np.full(SAMPLES, peer.RATE), turn=turn, zigzag=zigzag
        )
        ship = {"basic": peer.BASIC, "manoeuvring": peer.MANOEUVRING, "speed": peer.SPEED, "slew_rate": float(SLEW)}
        (folder / "ship.json").write_text(json.dumps(ship))
        subprocess.run([python, HERE / "peer_shipmmg.py", folder], check=True)
        theirs = dict(np.load(folder / "peer.npz"))
    return [*_turn(ours, theirs, turn), *_zigzag(ours, theirs, zigzag)]


def _turn(ours: OwnIntegration, theirs: dict[str, np.ndarray], rudder: np.ndarray) -> list[Line]:
    seconds, truth = float(theirs["turn_seconds"]), theirs["turn_tight"]
    fine, coarse = fastest(lambda: ours.replay(rudder)), fastest(lambda: ours.replay(rudder, COARSE))
    tolerance = _distance(theirs["turn"], truth)
    far = _distance(ours.replay(rudder, COARSE), truth[::COARSE])
    step = f"{COARSE * DT:g} s"
    return [
        Line("35 deg turn, 100 s: shipmmg", 1e3 * seconds, "ms"),
        Line("35 deg turn: its track off its own at tight tolerance", tolerance, "m"),
        Line(f"35 deg turn: ratio with steps of {DT:g} s", seconds / fine, "x"),
        at_least(f"35 deg turn: ratio with steps of {step}", seconds / coarse, "x", 20.0),
        at_most(f"35 deg turn: our track with steps of {step} off its tight one", far, "m", tolerance),
    ]


def _zigzag(ours: OwnIntegration, theirs: dict[str, np.ndarray], rudder: np.ndarray) -> list[Line]:
    seconds, truth = float(theirs["zigzag_seconds"]), theirs["zigzag_tight"]
    own = fastest(ours.zigzag)
    tolerance, far = _distance(theirs["zigzag_loose"], truth), _distance(ours.replay(rudder), truth)
    return [
        Line("20/20 zigzag, 100 s: shipmmg", 1e3 * seconds, "ms"),
        Line("20/20 zigzag: its track off its own at tight tolerance, same rudder", tolerance, "m"),
        at_least(f"20/20 zigzag: ratio with steps of {DT:g} s", seconds / own, "x", 20.0),
        at_most("20/20 zigzag: our track off its tight one, same rudder", far, "m", 0.01),
    ]
