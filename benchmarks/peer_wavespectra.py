"""Run by the peer's own Python: the spectra of `task.json` with wavespectra, written to `peer.npz`.

Usage: python peer_wavespectra.py FOLDER
"""

import json
import sys
from pathlib import Path

import numpy as np
from wavespectra.construct.frequency import jonswap, pierson_moskowitz


def main(folder: Path) -> None:
    """Density [m^2 / Hz], height and mean periods of each sea, one after another."""
    task = json.loads((folder / "task.json").read_text())
    f = np.linspace(task["f_low"], task["f_high"], task["count"])
    made = []
    for sea in task["seas"]:
        if sea["gamma"] == 1.0:
            made.append(pierson_moskowitz(f, fp=1.0 / sea["tp"], hs=sea["hs"]))
        else:
            made.append(jonswap(f, fp=1.0 / sea["tp"], gamma=sea["gamma"], hs=sea["hs"]))
    np.savez(
        folder / "peer.npz",
        f=f,
        density=np.stack([sea.values for sea in made]),
        tm01=[float(sea.spec.tm01()) for sea in made],
        tm02=[float(sea.spec.tm02()) for sea in made],
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
