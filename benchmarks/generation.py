"""From equations to machine code, on an empty cache; and what an exact Jacobian costs."""

import json
import os
import subprocess
import sys
import tempfile

import numpy as np
from measure import Line, at_most, fastest

from seatrial.numerics.kernels.integrate import evaluate, evaluate_tangent
from seatrial.physics.models.mmg import mmg
from seatrial.physics.models.published import kvlcc2_l7

ROWS = 200
PROGRAM = """
import json, time
import numpy, sympy, numba, seatrial.numerics.kernels.integrate, seatrial.core.equations.generate as generate
from seatrial.physics.models.mmg import mmg
t = [time.perf_counter()]
model = mmg(); t.append(time.perf_counter())
generate.source_text(model.equations); t.append(time.perf_counter())
model.compiled.load(); t.append(time.perf_counter())
print(json.dumps({"write": t[1] - t[0], "generate": t[2] - t[1], "compile": t[3] - t[2]}))
"""


def start_up_times() -> tuple[dict[str, float], dict[str, float]]:
    """Times [s] with an empty cache, and in a second process with the cache the first one left."""
    with tempfile.TemporaryDirectory() as cache:
        environment = {**os.environ, "SEATRIAL_CACHE": cache}
        command = [sys.executable, "-c", PROGRAM]
        runs = [subprocess.run(command, env=environment, capture_output=True, text=True, check=True) for _ in range(2)]
    return json.loads(runs[0].stdout), json.loads(runs[1].stdout)


def jacobian_ratio() -> tuple[float, float]:
    """Nanoseconds of one right-hand side, and value plus full Jacobian as a multiple of it."""
    model = kvlcc2_l7().applied_to(mmg())
    nx, width = len(model.states), len(model.states) + len(model.inputs) + len(model.parameters)
    states = np.tile([1.1, -0.2, 0.05, 0.0, 0.0, 0.3], (ROWS, 1))
    inputs = np.tile([0.3, 10.4, 0.0, 0.0], (ROWS, 1))
    p, out, jac = model.parameters.values, np.empty((ROWS, nx)), np.zeros((ROWS, nx, width))
    rows = np.tile(p, (ROWS, 1))
    compiled = model.compiled

    def values() -> None:
        for _ in range(100):
            evaluate(compiled.rates, states, inputs, p, 0.0, out)

    def jacobians() -> None:
        for _ in range(100):
            evaluate_tangent(compiled.rates_tangent, states, inputs, rows, 0.0, out, jac)

    plain = fastest(values)
    return 1e9 * plain / (100 * ROWS), fastest(jacobians) / plain


def run() -> list[Line]:
    """Generation, compilation, Jacobian."""
    cold, warm = start_up_times()
    count = len(mmg().parameters)
    nanoseconds, ratio = jacobian_ratio()
    return [
        at_most(f"MMG with {count} parameters: generate", cold["generate"], "s", 1.0),
        at_most(f"MMG with {count} parameters: compile, once a machine", cold["compile"], "s", 5.0),
        Line(f"MMG with {count} parameters: load in the next process", warm["compile"], "s"),
        Line("right-hand side", nanoseconds, "ns"),
        at_most("value and full Jacobian", ratio, "rhs", 3.0),
    ]
