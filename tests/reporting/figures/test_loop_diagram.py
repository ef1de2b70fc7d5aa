"""Any loop is drawn with every block, on the page."""

import pytest

from seatrial.core.figures.chart import Rectangle
from seatrial.core.results.tuning import Component
from seatrial.reporting.figures.control_charts import loop_diagram, signal_order


@pytest.mark.parametrize(
    "roles",
    [("plant",), ("term", "plant"), ("sensor",) * 4 + ("term",) * 5 + ("filter",) * 2, ("plant", "disturbance")],
)
def test_every_block_is_drawn_on_the_page(roles: tuple[str, ...]) -> None:
    chart = loop_diagram(
        [Component(role, f"b{k}", (1.0,), (1.0, 1.0)) for k, role in enumerate(roles)], "phi", "alpha_f"
    )
    assert chart is not None
    blocks = [mark for mark in chart.panels[0].marks if isinstance(mark, Rectangle)]
    assert len(blocks) == len(roles) and chart.width <= 1000.0
    assert all(0.0 <= block.left < block.right < chart.width and block.bottom >= 0.0 for block in blocks)


def test_components_are_in_the_order_of_the_signal() -> None:
    blocks = [Component(role, role, (1.0,), (1.0,)) for role in ("plant", "else", "term", "sensor")]
    assert [c.role for c in signal_order(blocks)] == ["sensor", "term", "plant", "else"]
    assert loop_diagram((), "phi", "alpha_f") is None
