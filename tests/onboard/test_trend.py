"""A few characters tell how a coefficient has moved."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from seatrial.onboard.table import sparkline, trend_arrow


@given(st.lists(st.floats(-1e9, 1e9) | st.just(float("nan")), max_size=50), st.floats(0, 1e9) | st.just(float("inf")))
def test_a_sparkline_never_fails_and_never_grows(values: list[float], half: float) -> None:
    assert len(sparkline(np.array(values), half)) <= 12


def test_a_sparkline_is_flat_where_the_move_is_small_beside_the_interval() -> None:
    rising = np.linspace(1.0, 2.0, 40)
    assert sparkline(rising, 0.1)[0] == "▁" and sparkline(rising, 0.1)[-1] == "█"
    assert len(set(sparkline(rising, 100.0))) <= 2


def test_arrows() -> None:
    assert [trend_arrow(np.array(e)) for e in ([np.inf, 2.0, 1.0], [1.0, 1.02], [1.0, 2.0], [1.0])] == [
        "↘",
        "→",
        "↗",
        "",
    ]
