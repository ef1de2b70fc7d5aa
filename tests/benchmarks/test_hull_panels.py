"""Hull panels: closed, facing the water, of the right volume; bad hulls are named."""

import sys

import numpy as np
import pytest
from benchmarks.hull_panels import HullPanels, capytaine_dataset, hull_from_sections, wigley

from seatrial.core.values import InputError


def _volume(hull: HullPanels) -> float:
    """Enclosed volume by the divergence theorem with (0, y, 0), from two triangles a panel; positive if facing out."""
    corners = hull.vertices[hull.faces]
    total = 0.0
    for one, two in ((1, 2), (2, 3)):
        a, b, c = corners[:, 0], corners[:, one], corners[:, two]
        total += np.sum(np.cross(b - a, c - a)[:, 1] / 2 * (a + b + c)[:, 1] / 3)
    return float(total)


def test_wigley_has_its_volume() -> None:
    """C_B = 4/9, from below, closing in with the square of the panel."""
    exact = 4 / 9 * 60.0 * 7.0 * 2.5
    missing = [1 - _volume(wigley(60.0, 7.0, 2.5, along=n, down=n // 4)) / exact for n in (16, 32)]
    assert 0 < missing[1] < missing[0] / 3.5
    assert missing[1] < 0.01


def test_port_and_starboard_mirror_each_other() -> None:
    hull = wigley(60.0, 7.0, 2.5, along=8, down=4)
    half = len(hull.vertices) // 2
    np.testing.assert_array_equal(hull.vertices[:half] * [1, -1, 1], hull.vertices[half:])
    assert hull.vertices[:, 2].max() == 0.0 and hull.vertices[:, 2].min() == -2.5


@pytest.mark.parametrize(
    ("L", "B", "T", "along", "words"),
    [(-1.0, 7.0, 2.0, 8, "L must"), (60.0, 0.0, 2.0, 8, "B must"), (60.0, 7.0, np.nan, 8, "T must"),
     (60.0, 7.0, 2.0, 2, "at least 4")],
)  # fmt: skip
def test_hulls_out_of_sense(L: float, B: float, T: float, along: int, words: str) -> None:
    with pytest.raises(InputError, match=words):
        wigley(L, B, T, along=along)


def test_a_half_breadth_out_of_sense() -> None:
    with pytest.raises(InputError, match="half breadth"):
        hull_from_sections(60.0, 2.0, lambda x, z: x + 0 * z, 8, 4)


def test_without_the_panel_code_the_extra_is_named(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "capytaine", None)
    with pytest.raises(InputError, match=r"seatrial\[hydro\]"):
        capytaine_dataset(wigley(60.0, 7.0, 2.5), np.array([0.5, 1.0]), np.array([0.0]))
