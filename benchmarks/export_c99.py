"""Exported C against the package's own simulation, for every built-in model: python benchmarks/export_c99.py

One step of 0.1 s from random states and inputs, relative to the state or, where that is larger, to the half-width from
which it was drawn; Jacobians relative to the largest entry of their row. Speed: one step after another of one craft on
one core, over the compiled kernel's, the first column plain -O2, the second compiled for this
processor, as the kernel is. Sanitizers: as many states under -fsanitize=address,undefined.
"""

import argparse
import ctypes
import subprocess
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import seatrial as st
from seatrial.core.values import NOTATION, Array
from seatrial.numerics.kernels.integrate import replay
from seatrial.numerics.kernels.linear import replay as replay_linear
from seatrial.physics.models.abkowitz import TERMS
from seatrial.physics.models.published import PARAMETER_SETS
from seatrial.physics.models.registry import MODELS
from seatrial.physics.simulate.linear import discrete_matrices
from seatrial.physics.simulate.replay import trajectory

STEP = 0.1  # s, sample interval of most records
STRICT = ("-O2", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")
LIKE_KERNEL = ("-march=native", "-fno-math-errno", "-fno-tree-vectorize")
"""What Numba does, too: code for this processor, no errno; vector loads behind scalar stores would stall."""
SPREAD = {"m": 10.0, "m/s": 2.0, "rad": 1.0, "rad/s": 0.2, "rps": 10.0, "N": 1e3, "N m": 1e3, "V": 15.0, "": 1.0}
"""SI unit -> half-width from which states and inputs are drawn."""
ALWAYS_POSITIVE = ("u", "omega_e", "voltage", "v_j")
DAMPING = ("X_u", "Y_v", "N_r")
CHUNK = 20_000  # states in memory at once

_DRIVER = """
#include "{name}.h"
#include <stdlib.h>
#include <stdio.h>
void many(long count, int steps, const double *u, double h, double *x)
{{
    long k;
    int s;
    {prepare}
    for (k = 0; k < count; k++)
        for (s = 0; s < steps; s++)
            {name}_step({argument}, u + 2 * k * {nu}, u + (2 * k + 1) * {nu}, {h} x + k * {nx});
}}
void slopes(const double *x, const double *u, double *xdot, double *jac)
{{
    {name}_rates_jacobian(&{name}_identified, x, u, xdot, jac);
}}
int main(int argc, char **argv)
{{
    const long count = argc > 2 ? atol(argv[2]) : 0;
    double *u = malloc(sizeof(double) * 2 * (count * {nu} + 1)), *x = malloc(sizeof(double) * (count * {nx} + 1));
    double y[{ny} + 1], xdot[{nx}], *jac = malloc(sizeof(double) * ({nx} + {ny}) * {name_upper}_NZ);
    FILE *file = fopen(argv[1], "rb");
    size_t got = fread(u, sizeof(double), 2 * count * {nu}, file);
    long k;
    got += fread(x, sizeof(double), count * {nx}, file);
    for (k = 0; k < count; k++) {{
        {name}_outputs(&{name}_identified, x + k * {nx}, u + 2 * k * {nu}, y);
        {name}_outputs_jacobian(&{name}_identified, x + k * {nx}, u + 2 * k * {nu}, y, jac);
        {name}_rates_jacobian(&{name}_identified, x + k * {nx}, u + 2 * k * {nu}, xdot, jac);
    }}
    many(count, 1, u, {step}, x);
    printf("%zu numbers read\\n", got);
    fclose(file);
    free(u);
    free(x);
    free(jac);
    return 0;
}}
"""


@dataclass(frozen=True, eq=False)
class RandomStates:
    """States (n, nx), the inputs at the beginning and the end of a step (n, 2, nu), half-widths of the states (nx,)."""

    states: Array
    inputs: Array
    scale: Array


def complete_model(name: str, rng: np.random.Generator) -> st.Model:
    """Return a built-in model with published values where there are some, random ones for what is missing."""
    sets = [make() for make in PARAMETER_SETS.values()]
    model = st.models.model_named(name)
    given = next((s for s in sets if name.startswith(s.model)), None)
    if given is not None:
        # heave_pitch_strip has coefficients at rest: those of the ship at 90 degrees to the waves
        values = {n if n in model.parameters else f"{n}_0": value for n, value in given.values.items()}
        values = {n: value for n, value in {**values, **given.ship.particulars}.items() if n in model.parameters}
        model = model.with_values(values)
    if name == "abkowitz":  # every term is zero unless it is estimated: small ones, and damping that keeps it stable
        model = model.with_values({n: float(1e-5 * rng.normal()) for n in TERMS} | dict.fromkeys(DAMPING, -0.01))
    return model.with_values({n: float(rng.uniform(0.5, 1.5)) for n in model.parameters.missing})


def random_states(model: st.Model, count: int, rng: np.random.Generator) -> RandomStates:
    """Return random states and inputs of the size that craft have."""

    def half_widths(names: tuple[str, ...]) -> Array:
        return np.array([SPREAD.get(NOTATION[n].unit if n in NOTATION else "", 1.0) for n in names])

    scale, input_scale = half_widths(model.states), half_widths(model.input_names)
    x = scale * rng.uniform(-1.0, 1.0, (count, len(scale)))
    u = input_scale * rng.uniform(-1.0, 1.0, (count, 2, len(input_scale)))
    for j, name in enumerate(model.input_names):
        if name in ALWAYS_POSITIVE:
            u[:, :, j] = np.abs(u[:, :, j]) + 0.1
    return RandomStates(x, u, scale)


def own_steps(model: st.Model, draw: RandomStates) -> Array:
    """Return the states after one step by the package's kernels, shape (n, nx)."""
    count, (nx, nu) = len(draw.states), (len(model.states), len(model.inputs))
    offsets = 2 * np.arange(count + 1)
    select, failed, y = np.arange(nx), np.full(count, -1), np.empty((2 * count, nx))
    inputs = np.ascontiguousarray(draw.inputs.reshape(2 * count, nu))
    values = model.parameters.values
    if model.is_affine:
        m = discrete_matrices(model, values[None], STEP, select, np.empty(0, dtype=np.int64))
        fine = np.column_stack([inputs, np.ones(2 * count)])
        replay_linear(m.e, m.g0, m.g1, m.c, m.d, np.zeros(count, dtype=np.int64), fine, offsets, 1,
                      np.ascontiguousarray(draw.states), y, failed)  # fmt: skip
    else:
        none, code = np.zeros((count, nu)), model.compiled
        place = np.ascontiguousarray(np.column_stack([offsets[:-1], offsets[:-1], offsets[1:]]))
        replay(code.rates, code.outputs, inputs, place, np.ones(nu), offsets, 0, count, STEP, 1,
               np.ascontiguousarray(draw.states),
               np.tile(values, (count, 1)), np.ones_like(none), none, none, select, 0, y, failed)  # fmt: skip
    return y[1::2]


def write_and_compile(model: st.Model, folder: Path, name: str, *options: str) -> ctypes.CDLL:
    """Return the exported model as a library, compiled under the strict options, with a function `many`."""
    st.export(model, "c99", folder / name)
    affine = model.is_affine
    (folder / name / "driver.c").write_text(
        _DRIVER.format(
            name=name, name_upper=name.upper(), nx=len(model.states), nu=len(model.inputs), ny=len(model.outputs),
            step=STEP, h="" if affine else "h,", argument="&m" if affine else f"&{name}_identified",
            prepare=f"{name}_propagator m; {name}_prepare(&{name}_identified, h, &m);" if affine else "",
        )
    )  # fmt: skip
    return compiled(folder, name, *options)


def compiled(folder: Path, name: str, *options: str) -> ctypes.CDLL:
    """Return the written model as a library, compiled with more options."""
    result = f"lib{name}{len(options)}.so"
    _compile(folder / name, name, ("-fPIC", *options), "-shared", result)
    library = ctypes.CDLL(str(folder / name / result))
    library.many.argtypes = [ctypes.c_long, ctypes.c_int, ctypes.c_void_p, ctypes.c_double, ctypes.c_void_p]
    library.slopes.argtypes = [ctypes.c_void_p] * 4
    return library


def _compile(folder: Path, name: str, options: tuple[str, ...], kind: str, result: str) -> None:
    """Compile the exported source under the strict options, and link it with the driver."""
    for source in (name, "driver"):
        strict = STRICT if source == name else STRICT[:2]
        subprocess.run(["gcc", *strict, *options, "-c", f"{source}.c", "-o", f"{source}.o"], cwd=folder, check=True)
    objects = (f"{name}.o", "driver.o", "-lm", "-o", result)
    subprocess.run(["gcc", *options, *filter(None, [kind]), *objects], cwd=folder, check=True)


def exported_steps(library: ctypes.CDLL, draw: RandomStates, steps: int = 1) -> Array:
    """Return the states after some steps of the exported model, shape (n, nx)."""
    x, u = draw.states.copy(), np.ascontiguousarray(draw.inputs)
    library.many(len(x), steps, u.ctypes.data, STEP, x.ctypes.data)
    return x


def step_error(library: ctypes.CDLL, model: st.Model, draw: RandomStates) -> float:
    """Return the largest relative difference of a step; states that leave all bounds in both are left out."""
    own, exported = own_steps(model, draw), exported_steps(library, draw)
    size = np.maximum(np.maximum(np.abs(own), np.abs(draw.states)), draw.scale)
    fine = np.isfinite(own).all(axis=1)
    assert fine.mean() > 0.9  # nearly all draws must count
    return float(np.max(np.abs(own - exported)[fine] / size[fine]))


def jacobian_error(library: ctypes.CDLL, model: st.Model, draw: RandomStates) -> float:
    """Return the largest difference of the Jacobian of the rates, relative to the largest entry of the row."""
    nx = len(model.states)
    width, worst = nx + len(model.inputs) + len(model.parameters), 0.0
    rates, own, exported = np.empty(nx), np.zeros((nx, width)), np.empty((nx, width))
    values = model.parameters.values
    for x, u in zip(draw.states, np.ascontiguousarray(draw.inputs[:, 0]), strict=True):
        model.compiled.rates_tangent(0.0, x, u, values, rates, own)
        library.slopes(x.ctypes.data, u.ctypes.data, rates.ctypes.data, exported.ctypes.data)
        largest = np.abs(own).max(axis=1, keepdims=True) + np.finfo(float).tiny
        worst = max(worst, float(np.max(np.abs(own - exported) / largest)))
    return worst


def speed_ratio(library: ctypes.CDLL, model: st.Model, steps: int = 200_000) -> float:
    """Return steps a second of the exported C over those of the compiled kernel; the motion stays bounded."""
    nx = len(model.states)
    start = np.full((1, nx), 0.01)  # SI, off rest
    one = [1.0 if name in ALWAYS_POSITIVE else 0.02 for name in model.input_names]  # SI, small; a speed, a frequency
    inputs = np.tile(one, (steps + 1, 1))

    def own() -> None:
        states, _ = trajectory(model, inputs, STEP, start[0])
        assert np.isfinite(states[-1]).all()

    still = RandomStates(start, np.tile(one, (1, 2, 1)), np.ones(nx))
    times = {"own": [], "c": []}
    for _ in range(9):  # the fastest of nine
        for name, run in (("own", own), ("c", lambda: exported_steps(library, still, steps))):
            began = time.process_time()
            run()
            times[name].append(time.process_time() - began)
    return min(times["own"]) / min(times["c"])


def sanitized(folder: Path, name: str, draw: RandomStates) -> str:
    """Run the draws under the address and undefined-behaviour sanitizers; return what they report, empty if nothing."""
    _compile(folder / name, name, ("-g", "-fsanitize=address,undefined", "-fno-sanitize-recover=all"), "", "sanitized")
    (folder / name / "draws.bin").write_bytes(np.ascontiguousarray(draw.inputs).tobytes() + draw.states.tobytes())
    run = subprocess.run(["./sanitized", "draws.bin", str(len(draw.states))], cwd=folder / name, capture_output=True)
    return "" if run.returncode == 0 else run.stderr.decode()[-500:]


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--states", type=int, default=1_000_000)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--models", nargs="+", default=list(MODELS))
    arguments = parser.parse_args()
    print(
        f"{'model':20s} {'step':>9s} {'Jacobian':>9s} {'-O2':>6s} {'native':>6s}  sanitizers, {arguments.states} states"
    )
    for name in arguments.models:
        rng = np.random.default_rng(arguments.seed)
        model = complete_model(name, rng)
        with tempfile.TemporaryDirectory() as place:
            folder = Path(place)
            library = write_and_compile(model, folder, name)
            chunks = max(1, arguments.states // CHUNK)
            error = max(step_error(library, model, random_states(model, CHUNK, rng)) for _ in range(chunks))
            slopes = jacobian_error(library, model, random_states(model, 1000, rng))
            plain = speed_ratio(library, model)
            native = speed_ratio(compiled(folder, name, *LIKE_KERNEL), model)
            report = sanitized(folder, name, random_states(model, arguments.states, rng))
        print(f"{name:20s} {error:9.1e} {slopes:9.1e} {plain:6.2f} {native:6.2f}  {report or 'clean'}", flush=True)


if __name__ == "__main__":
    main()
