"""Trials of small craft, written to files as a user would have them."""

from collections.abc import Callable, Mapping
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.equations import Model
from seatrial.core.values import Record
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import replay

TRUTH = {"K": 0.15, "T": 8.0}
NOISE = {"r": 1e-3, "psi": 3e-3}
NOMOTO = """
[ship]
name = "craft"
L = 8.0

[[records]]
files = "*.csv"
header_lines = 1
{roles}
time = {{ column = "time", unit = "s" }}
{layout}

[records.channels]
u = {{ column = "u", unit = "m/s" }}
r = {{ column = "r", unit = "rad/s" }}
psi = {{ column = "psi", unit = "rad" }}
delta = {{ column = "delta", unit = "rad", positive = "starboard" }}

[model]
name = "nomoto"
{model}

[truth]
K = 0.15
T = 8.0
{more}
"""


def square(rows: int, dt: float = 0.5, period: float = 52.0, phase: float = 0.0, size: float = 0.3) -> Record:
    """A planned record: rudder hard over from side to side, slewing for a few samples."""
    time = dt * np.arange(rows)
    delta = size * np.clip(8.0 * np.sin(2 * np.pi * (time + phase) / period), -1.0, 1.0)
    return Record.from_arrays("plan", time, {"delta": delta, "u": np.full(rows, 2.0)})


def steered(
    model: Model, plan: Record, rng: np.random.Generator, noise: Mapping[str, float], zero: float = 0.0
) -> Record:
    """What sensors would show; the rudder's real angle is `zero` larger than the recorded one."""
    moved = plan.with_channel("delta", plan.channel("delta").with_values(plan["delta"] + zero))
    record = replay(model, moved, {"r": 0.0}).with_channel("delta", plan.channel("delta"))
    for symbol, size in noise.items():
        channel = record.channel(symbol)
        record = record.with_channel(
            symbol, channel.with_values(channel.values + size * rng.standard_normal(len(record)))
        )
    return record.with_channel("u", plan.channel("u"))


def write(record: Record, path: Path, columns: tuple[str, ...] = ("u", "r", "psi", "delta")) -> None:
    """Time and columns, header of bare names."""
    table = np.column_stack([record.time, *(record[c] for c in columns)])
    np.savetxt(path, table, delimiter=",", header=",".join(["time", *columns]), comments="", fmt="%.12g")


WriteTrial = Callable[..., Path]


@pytest.fixture
def trial_of(tmp_path: Path) -> WriteTrial:
    """Writes runs (name -> rudder zero) and the trial file over them, and gives its path."""

    def write_runs(
        runs: Mapping[str, float],
        *,
        layout: str = "",
        model: str = "",
        more: str = "",
        noise: Mapping[str, float] = NOISE,
        rows: int = 500,
    ) -> Path:
        rng, truth = np.random.default_rng(11), nomoto().with_values(TRUTH)
        for i, (name, zero) in enumerate(runs.items()):
            write(steered(truth, square(rows, phase=7.0 * i), rng, noise, zero), tmp_path / f"{name}.csv")
        roles = {"validate": "v_", "leave_out": "x_"}
        said = [f'{r} = "{start}*"' for r, start in roles.items() if any(n.startswith(start) for n in runs)]
        text = NOMOTO.format(roles="\n".join(said), layout=layout, model=model, more=more)
        (tmp_path / "trial.toml").write_text(text)
        return tmp_path / "trial.toml"

    return write_runs
