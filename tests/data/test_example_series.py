"""The embedded trial series: seeded, noisy as stated, finer than any fitted model, and the files written from it."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.data.example_series import EXAMPLE_SEED, SENSOR_NOISE, demo_series, main, simulate_run, true_model
from seatrial.physics.simulate import replay


def test_the_same_seed_gives_the_same_bits() -> None:
    first, second, other = (demo_series(seed, executes=1)[0] for seed in (1, 1, 2))
    assert all(np.array_equal(a[s], b[s]) for a, b in zip(first, second, strict=True) for s in a.channels)
    assert not np.array_equal(first[0]["u"], other[0]["u"])


def test_noise_has_the_stated_size_and_inputs_have_none() -> None:
    records, model = demo_series(3, executes=1)
    clean = simulate_run(model, "consecutive-zigzags:1")
    for symbol, deviation in SENSOR_NOISE.items():
        assert np.std(records[0][symbol] - clean[symbol]) == pytest.approx(deviation, rel=0.05)
    assert np.array_equal(records[0]["delta"], clean["delta"])


def test_the_generator_is_finer_than_a_replay_at_ten_hertz() -> None:
    """The difference is there, and far below the sensor noise."""
    clean = simulate_run(true_model(), "zigzag:25/25")
    coarse = replay(true_model(), clean)
    assert 1e-9 < np.max(np.abs(coarse["psi"] - clean["psi"])) < 0.1 * SENSOR_NOISE["psi"]
    assert np.max(np.hypot(coarse["x0"] - clean["x0"], coarse["y0"] - clean["y0"])) < 0.1 * SENSOR_NOISE["x0"]


def test_held_out_runs_stay_within_the_models_reach() -> None:
    for record in demo_series(0, executes=1)[0][1:]:
        smooth = simulate_run(true_model(), record.name.replace("_", ":", 1).replace("_", "/"))
        assert np.degrees(np.abs(np.arctan2(smooth["v"], smooth["u"]))).max() < 20.0


def test_the_example_files_are_what_the_command_writes(tmp_path: Path, repository: Path) -> None:
    main(str(tmp_path))
    kept = repository / "examples" / "waterjet"
    written = sorted(p.name for p in tmp_path.iterdir())
    assert written == sorted(p.name for p in kept.glob("*.csv"))
    assert sum(p.stat().st_size for p in tmp_path.iterdir()) <= 400_000
    for name in written:
        ours, theirs = (np.genfromtxt(folder / name, delimiter=",", skip_header=1) for folder in (tmp_path, kept))
        assert ours == pytest.approx(theirs, abs=0.02), f"rewrite examples/waterjet (seed {EXAMPLE_SEED})"
