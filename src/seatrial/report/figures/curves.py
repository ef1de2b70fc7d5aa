"""A study's own curves over one pair of axes; line styles tell them apart without colour."""

from seatrial.report.figures.canvas import ACCENT, INK, SECOND, WIDTH, canvas, decimated, styled, svg, thinned
from seatrial.results.study import Figure

STYLES = (
    (INK, "-"), (ACCENT, "--"), (SECOND, "-."), ("#6c7a89", ":"), ("#2e7d5b", (0, (6, 1, 1, 1, 1, 1))),
    ("#8e6c1f", (0, (3, 1))), ("#5b4a7a", (0, (1, 2))),
)  # fmt: skip


def curves(drawn: Figure, prefix: str) -> str:
    """One figure of a study."""
    with styled():
        figure = canvas(4.2 if drawn.is_map else 2.9, 4.6 if drawn.is_map else WIDTH * 0.82)
        axes = figure.add_subplot()
        for k, one in enumerate(drawn.curves):
            colour, style = STYLES[k % len(STYLES)]
            x, y = thinned(one.x, one.y) if drawn.is_map else decimated(one.x, one.y)
            axes.plot(x, y, color=colour, linestyle=style, linewidth=1.1, label=one.name)
        axes.set_xlabel(drawn.x_label)
        axes.set_ylabel(drawn.y_label)
        if drawn.is_map:
            axes.set_aspect("equal", adjustable="datalim")
        if len(drawn.curves) > 1:
            axes.legend(loc="best")
        return svg(figure, drawn.title, prefix)
