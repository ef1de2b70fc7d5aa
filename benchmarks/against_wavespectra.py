"""The same seas with wavespectra: densities and mean periods of JONSWAP and Pierson-Moskowitz."""

import json
import subprocess
import tempfile
from pathlib import Path

import numpy as np
from against_shipmmg import peers_python
from measure import Line, at_most

from seatrial.physics.sea.spectrum import Spectrum, jonswap

HERE = Path(__file__).parent
SEAS = [
    {"hs": 3.0, "tp": 10.0, "gamma": 1.0},
    {"hs": 3.0, "tp": 10.0, "gamma": 3.3},
    {"hs": 0.88, "tp": 6.25, "gamma": 1.7},
    {"hs": 7.5, "tp": 15.0, "gamma": 7.0},
]
TASK = {"f_low": 0.01, "f_high": 3.0, "count": 299_001, "seas": SEAS}


def ours(sea: dict[str, float]) -> Spectrum:
    """Gamma of one is Pierson-Moskowitz, here as there."""
    return jonswap(sea["hs"], sea["tp"], sea["gamma"])


def theirs(folder: Path, python: Path) -> dict[str, np.ndarray]:
    """What wavespectra makes of the task."""
    (folder / "task.json").write_text(json.dumps(TASK))
    subprocess.run([python, HERE / "peer_wavespectra.py", folder], check=True)
    return dict(np.load(folder / "peer.npz"))


def run() -> list[Line]:
    """Largest distances, relative to the peak density and to the period.

    wavespectra scales by the sum of ordinates over its grid: with ten times fewer frequencies the distance of the
    steepest sea grows a thousandfold. Its moments count the last ordinate whole, which its periods show.
    """
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        try:
            python = peers_python(folder / "peers")
        except subprocess.CalledProcessError:
            print("  left out: the peer's packages could not be installed")
            return []
        peer = theirs(folder, python)
    return [line for i, sea in enumerate(SEAS) for line in _lines(sea, peer, i)]


def _lines(sea: dict[str, float], peer: dict[str, np.ndarray], i: int) -> list[Line]:
    spectrum = ours(sea)
    density = 2.0 * np.pi * spectrum.density(2.0 * np.pi * peer["f"])
    far = float(np.abs(density - peer["density"][i]).max() / density.max())
    T1, T2 = _periods(spectrum, 2.0 * np.pi * float(peer["f"][-1]))
    name = f"Hs {sea['hs']:g} m, Tp {sea['tp']:g} s, gamma {sea['gamma']:g}"
    return [
        at_most(f"{name}: density, share of its peak", far, "1", 1e-9),
        at_most(f"{name}: T1", abs(T1 / float(peer["tm01"][i]) - 1.0), "1", 1e-7),
        at_most(f"{name}: T2", abs(T2 / float(peer["tm02"][i]) - 1.0), "1", 1e-7),
    ]


def _periods(spectrum: Spectrum, omega: float) -> tuple[float, float]:
    """T1 and T2 [s] of what lies below `omega`, where the peer's grid ends; the tail is A / omega^5 there."""
    m0, m1, m2 = (spectrum.moment(n) - spectrum.A * omega ** (n - 4) / (4 - n) for n in (0, 1, 2))
    return float(2.0 * np.pi * m0 / m1), float(2.0 * np.pi * np.sqrt(m0 / m2))
