"""Exported CasADi and MATLAB functions against the model, for every built-in model.

    python -m benchmarks.export_scripts --octave octave-cli --casadi /path/to/venv/bin/python

Rates and, of CasADi, their Jacobian by the states and inputs at random states; differences relative to the largest
entry of the row. CasADi lies in an environment of its own: the package does not need it.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np
from benchmarks.export_c99 import RandomStates, complete_model, random_states

import seatrial as st
from seatrial.core.values import Array
from seatrial.physics.models.registry import MODELS

_CASADI = """
import json, sys
import casadi as ca
sys.path.insert(0, ".")
import {name} as model
rates = model.rates()
x, u, p = (ca.SX.sym(n, rates.size1_in(i)) for i, n in enumerate("xup"))
xdot = rates(x, u, p)
both = ca.Function("both", [x, u, p], [xdot, ca.jacobian(xdot, ca.vertcat(x, u))])
points = json.load(open("points.json"))
values = [both(a, b, model.IDENTIFIED) for a, b in points]
json.dump([[v.full().tolist(), j.full().tolist()] for v, j in values], open("values.json", "w"))
"""


def own_values(model: st.Model, draw: RandomStates) -> tuple[Array, Array]:
    """Return rates (n, nx) and their Jacobian by states and inputs (n, nx, nx + nu)."""
    nx, nu = len(model.states), len(model.inputs)
    rates, jacobian = (
        np.empty((len(draw.states), nx)),
        np.zeros((len(draw.states), nx, nx + nu + len(model.parameters))),
    )
    for k, (x, u) in enumerate(zip(draw.states, np.ascontiguousarray(draw.inputs[:, 0]), strict=True)):
        model.compiled.rates_tangent(0.0, x, u, model.parameters.values, rates[k], jacobian[k])
    return rates, jacobian[:, :, : nx + nu]


def _largest_relative(own: Array, exported: Array) -> float:
    """Differences over the largest size of each entry's row (last axis)."""
    size = np.abs(own).max(axis=-1, keepdims=True) + np.finfo(float).tiny
    return float(np.max(np.abs(own - exported) / size))


def casadi_errors(
    model: st.Model, draw: RandomStates, folder: Path, python: str = sys.executable
) -> tuple[float, float]:
    """Return the largest relative differences of rates and of their Jacobian by the states and inputs."""
    name = f"craft_{model.name}"
    st.export(model, "casadi", folder / f"{name}.py")
    points = [[x.tolist(), u.tolist()] for x, u in zip(draw.states, draw.inputs[:, 0], strict=True)]
    (folder / "points.json").write_text(json.dumps(points))
    subprocess.run([python, "-c", _CASADI.format(name=name)], cwd=folder, check=True)
    values = json.loads((folder / "values.json").read_text())
    rates, jacobian = own_values(model, draw)
    exported = np.array([v for v, _ in values])[:, :, 0]
    return _largest_relative(rates, exported), _largest_relative(jacobian, np.array([j for _, j in values]))


def octave_error(model: st.Model, draw: RandomStates, folder: Path, octave: str = "octave-cli") -> float:
    """Return the largest relative difference of the rates."""
    place = folder / model.name
    st.export(model, "matlab", place)
    np.savetxt(place / "points.txt", np.hstack([draw.states, draw.inputs[:, 0]]), fmt="%.17g")
    nx = len(model.states)
    script = (
        f"points = load('points.txt'); n = rows(points); out = zeros(n, {nx}); mat = load('{model.name}.mat'); "
        f"for k = 1:n, out(k, :) = {model.name}(points(k, 1:{nx})', points(k, {nx + 1}:end)', mat.p)'; end; "
        "file = fopen('values.txt', 'w'); fprintf(file, '%.17g\\n', out'); fclose(file);"
    )
    subprocess.run([octave, "--quiet", "--no-init-file", "--eval", script], cwd=place, check=True)
    return _largest_relative(own_values(model, draw)[0], np.loadtxt(place / "values.txt").reshape(-1, nx))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--octave", default="octave-cli")
    parser.add_argument("--casadi", default=sys.executable)
    parser.add_argument("--states", type=int, default=1000)
    arguments = parser.parse_args()
    print(f"{'model':20s} {'Octave':>9s} {'CasADi':>9s} {'Jacobian':>9s}  {arguments.states} states")
    for name in MODELS:
        rng = np.random.default_rng(0)
        model = complete_model(name, rng)
        draw = random_states(model, arguments.states, rng)
        with tempfile.TemporaryDirectory() as place:
            octave = octave_error(model, draw, Path(place), arguments.octave)
            value, slope = casadi_errors(model, draw, Path(place), arguments.casadi)
        print(f"{name:20s} {octave:9.1e} {value:9.1e} {slope:9.1e}", flush=True)


if __name__ == "__main__":
    main()
