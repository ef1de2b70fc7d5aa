"""Grouped bars: heights to scale on both axes, what has no bar is marked, and values that fit no label are refused."""

import re

import pytest

from seatrial.core.figures.bars import SHADES, bars
from seatrial.core.results import Bars
from seatrial.core.values import InputError

_RECTANGLE = re.compile(r'<rect x="([\d.]+)" y="([\d.]+)" width="([\d.]+)" height="([\d.]+)" fill="(#\w+)"/>')


def drawn(made: Bars) -> list[tuple[float, float, str]]:
    """Top, height and shade of each bar, the legend's squares left out."""
    found = [(float(y), float(h), fill) for _, y, _, h, fill in _RECTANGLE.findall(bars(made))]
    return found[len(made.series) :]


def test_heights_are_to_scale_and_negative_values_hang_below_zero() -> None:
    (top, high, _), (below, deep, _) = drawn(Bars("b", ("a", "c"), {"x": (4.0, -2.0)}, "%"))
    assert high == pytest.approx(2.0 * deep, abs=0.2)
    assert below == pytest.approx(top + high, abs=0.2)


def test_heights_on_a_logarithmic_axis_count_decades() -> None:
    made = drawn(Bars("b", ("a", "c", "d"), {"x": (1.0, 10.0, 100.0)}, "1", is_logarithmic=True))
    heights = [h for _, h, _ in made]
    assert heights[2] - heights[1] == pytest.approx(heights[1] - heights[0], abs=0.2)
    assert heights[1] - heights[0] > 20.0


def test_series_stand_side_by_side_in_shades_of_their_own() -> None:
    made = drawn(Bars("b", ("a", "c"), {"x": (1.0, 2.0), "y": (3.0, 4.0)}, "1"))
    assert [shade for _, _, shade in made] == [SHADES[0], SHADES[1]] * 2


@pytest.mark.parametrize(("value", "mark"), [(None, "–"), (float("nan"), "–"), (float("inf"), "∞"), (0.0, "0")])
def test_what_has_no_bar_is_marked(value: float | None, mark: str) -> None:
    made = Bars("b", ("a", "c"), {"x": (value, 3.0)}, "1", is_logarithmic=True)
    assert len(drawn(made)) == 1 and f">{mark}</text>" in bars(made)
    assert "nan" not in bars(made) and "inf" not in bars(made)


def test_many_long_names_stay_on_the_page() -> None:
    names = {f"a method with a rather long name, number {k}": (1.0, 2.0) for k in range(6)}
    found = bars(Bars("b", tuple(f"coefficient of {c}" * 4 for c in "ab"), names, "1"))
    starts = [float(x) for x in re.findall(r'<text x="([\d.]+)"', found)]
    assert max(starts) < 864.0 and "rotate(-90" in found


def test_values_that_fit_no_label_or_no_axis_are_refused() -> None:
    with pytest.raises(InputError, match="series 'x' has 1 values for 2 labels"):
        Bars("b", ("a", "c"), {"x": (1.0,)}, "1")
    with pytest.raises(InputError, match="logarithmic axis"):
        Bars("b", ("a",), {"x": (-1.0,)}, "1", is_logarithmic=True)


def test_no_values_no_picture() -> None:
    assert bars(Bars("b", (), {}, "1")) == ""
