"""Run by the peer's own Python: simulate what `task.npz` asks for with shipmmg and write `peer.npz`.

Usage: python peer_shipmmg.py FOLDER
"""

import json
import sys
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np
from shipmmg.mmg_3dof import (
    Mmg3DofBasicParams,
    Mmg3DofManeuveringParams,
    simulate_mmg_3dof,
    zigzag_test_mmg_3dof,
)


def fastest(function: Callable[[], object], repeats: int = 5) -> float:
    """Shortest of several runs [s]."""
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        function()
        times.append(time.perf_counter() - began)
    return min(times)


def main(folder: Path) -> None:
    """Turn and zigzag, timed; both rudder histories replayed, once as shipped and once with tight tolerances."""
    task = np.load(folder / "task.npz")
    ship = json.loads((folder / "ship.json").read_text())
    basic = Mmg3DofBasicParams(*ship["basic"].values())
    params = Mmg3DofManeuveringParams(*ship["manoeuvring"].values())
    t, n = task["time"], task["n"]

    def replayed(rudder: np.ndarray, **options: float) -> np.ndarray:
        solution = simulate_mmg_3dof(basic, params, t, rudder, n, u0=ship["speed"], **options)
        return solution.sol(t)[:6].T

    def zigzag() -> object:
        return zigzag_test_mmg_3dof(
            basic, params, np.radians(20.0), np.radians(20.0), t, n, δ_rad_rate=ship["slew_rate"], u0=ship["speed"]
        )

    np.savez(
        folder / "peer.npz",
        turn=replayed(task["turn"]),
        turn_tight=replayed(task["turn"], rtol=1e-9, atol=1e-9),
        zigzag_tight=replayed(task["zigzag"], rtol=1e-9, atol=1e-9),
        zigzag_loose=replayed(task["zigzag"]),
        turn_seconds=fastest(lambda: replayed(task["turn"])),
        zigzag_seconds=fastest(zigzag),
    )


if __name__ == "__main__":
    main(Path(sys.argv[1]))
