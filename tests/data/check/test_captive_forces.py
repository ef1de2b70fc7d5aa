"""The signs of force points: right ones pass, every turned column is named."""

from dataclasses import replace
from itertools import product

import numpy as np
import pytest

from seatrial.core.values import ForceContent, ForcePoints, Severity
from seatrial.data.check.captive_forces import force_findings
from seatrial.estimation.problem.static_forces import StaticForces
from seatrial.physics.models.published import kvlcc2


def table(includes: ForceContent = ForceContent.HYDRODYNAMIC, n: float = 10.4, noise: float = 0.03) -> ForcePoints:
    """KVLCC2 over drift, yaw rate and rudder angle, with scatter."""
    grid = np.array(list(product(np.radians((-15.0, -6.0, 0.0, 6.0, 15.0)), (-0.6, 0.0, 0.6), (-0.5, 0.0, 0.5))))
    beta, r, delta = grid.T
    motion = {
        "u": 1.2 * np.cos(beta), "v": -1.2 * np.sin(beta), "r": r * 1.2 / 7.0, "delta": delta, "n": np.full(len(r), n),
    }  # fmt: skip
    zero = np.zeros(len(beta))
    empty = ForcePoints("tank", motion, {"X": zero, "Y": zero, "N": zero}, {"X": 1.0, "Y": 1.0, "N": 1.0}, includes)
    exact = StaticForces(kvlcc2(), empty).forces(kvlcc2().parameters.values)
    exact = exact + noise * np.ptp(exact, axis=0) * np.random.default_rng(5).standard_normal(exact.shape)
    return replace(
        empty, forces=dict(zip("XYN", exact.T, strict=True)), columns={"beta": "drift", "Y": "Fy", "N": "Mz", "X": "Fx"}
    )


def turned(points: ForcePoints, symbol: str) -> ForcePoints:
    """One column with the wrong sign."""
    if symbol in points.forces:
        return replace(points, forces={**points.forces, symbol: -points.forces[symbol]})
    return replace(points, motion={**points.motion, symbol: -points.motion[symbol]})


@pytest.mark.parametrize("includes", list(ForceContent))
@pytest.mark.parametrize("n", [10.4, 0.0])
def test_right_signs_pass(includes: ForceContent, n: float) -> None:
    assert force_findings(table(includes, n)) == ()


@pytest.mark.parametrize(
    ("symbol", "named"),
    [
        ("Y", "column 'Fy' (Y)"),
        ("N", "column 'Mz' (N)"),
        ("v", "column 'drift' (beta)"),
        ("r", "'r'"),
        ("delta", "'delta'"),
    ],
)
def test_a_turned_column_is_named(symbol: str, named: str) -> None:
    (finding,) = force_findings(turned(table(), symbol))
    assert finding.severity is Severity.ERROR
    assert finding.code == "force-sign"
    assert f"{named} looks turned" in finding.message
    assert "turn positive of forces." in finding.advice


def test_drag_that_drives_is_named() -> None:
    (finding,) = force_findings(turned(table(ForceContent.HULL), "X"))
    assert "column 'Fx' (X) looks turned" in finding.message
    (finding,) = force_findings(turned(table(n=0.0), "X"))
    assert '"forward" or "aft"' in finding.advice
    assert force_findings(turned(table(), "X")) == (), "with a turning propeller nobody knows"


def test_forces_of_another_prime_system_are_noticed() -> None:
    unit, length_over_draught = 500.0 * 7.0 * 0.46, 7.0 / 0.46
    assert force_findings(table(), unit) == ()
    for factor in (length_over_draught, 1 / length_over_draught):
        points = table()
        points = replace(points, forces={f: factor * x for f, x in points.forces.items()})
        (finding,) = force_findings(points, unit)
        assert finding.code == "force-size"
        assert "check the prime system" in finding.advice


def test_few_points_or_a_single_force_do_not_stumble() -> None:
    points = table()
    few = replace(
        points,
        motion={s: x[:3] for s, x in points.motion.items()},
        forces={f: x[:3] for f, x in points.forces.items()},
    )
    assert force_findings(few) == ()
    (finding,) = force_findings(turned(replace(points, forces={"Y": points.forces["Y"]}), "Y"))
    assert "looks turned" in finding.message
