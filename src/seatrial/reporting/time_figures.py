"""Figures of runs on a page: the track as SVG, the channels as data that the page's script draws and links."""

import json
from collections.abc import Sequence

import numpy as np
from markupsafe import Markup

from seatrial.core.figures.chart import Chart, LegendEntry, text_width, thinned
from seatrial.core.figures.run import NARROW, ChannelPanel, RunView, is_slender, track_chart
from seatrial.core.figures.svg_text import svg
from seatrial.core.figures.time_plot import BAND_POINTS, packed, plot_document
from seatrial.core.text.numbers import duration, significant

# px that an entry of a legend is wider than estimated; chosen
SPARE = 8.0
NO_SCRIPT = "Time series are drawn by this page’s own script; allow it for this file to see them."


def run_figure(view: RunView, *, x_label: str = "t [s]", is_wide: bool = False,
               track: Chart | None = None, is_first: bool = False) -> Markup:  # fmt: skip
    """Return the figure of one run: legend, track with its band, and linked plots of its channels.

    Args:
        is_wide: whether each channel takes the whole width.
        track: a picture of the view's tracks in place of the plain one.
        is_first: whether a strip is drawn for narrow screens, too, on which others are moved sideways.
    """
    track = track or track_chart(view)
    document = plot_document(view.channels, x_label=x_label) if view.channels else None
    shape = "" if track is None else (" strip" if is_slender(view.tracks) else " square")
    shape += " wide" if is_wide else ""
    parts = [_legend(view.legend), f'<div class="run{shape}">']
    if track is not None:
        parts.append(f'<div class="track">{svg(track)}</div>')
        if is_first and is_slender(view.tracks):
            parts.append(f'<div class="track narrow">{svg(track_chart(view, NARROW))}</div>')
    if document is not None:
        document["title"] = view.title
        document["about"] = [_description(channel) for channel in view.channels]
        document["track"] = [] if track is None else _positions(view, track)
        # a closing tag inside the text would end the element
        data = json.dumps(document, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
        parts.append(
            f'<div class="series" data-panels="{len(view.channels)}"><script type="application/json">{data}</script>'
            f"<noscript>{NO_SCRIPT}</noscript></div>"
        )
    return Markup("".join([*parts, "</div>"]))


def _legend(entries: Sequence[LegendEntry]) -> str:
    """One picture for each entry, so that they wrap on a narrow screen."""
    pictures = (svg(Chart(e.words, (), (e,), e.sample_width + text_width(e.words) + SPARE)) for e in entries)
    return f'<div class="legend">{"".join(pictures)}</div>' if entries else ""


def _positions(view: RunView, track: Chart) -> list[list[dict[str, object]]]:
    """Where each track is in the picture [px] at equal times, for the mark that follows the cursor."""
    panel = track.panels[0]
    places = []
    for one in view.tracks:
        across, along = (one.north, one.east) if panel.is_y_down else (one.east, one.north)
        x, y = thinned(panel.px(across), panel.py(along), BAND_POINTS)
        places.append([packed(x), packed(y)])
    return places


def _description(channel: ChannelPanel) -> str:
    """What a reader who does not see the plot learns of it: each curve with its range."""
    time, texts = channel.curves[0].time, []
    for curve in channel.curves:
        finite = curve.values[np.isfinite(curve.values)]
        if finite.size:
            between = f"from {significant(float(finite.min()), 3)} to {significant(float(finite.max()), 3)}"
            texts.append(f"{curve.name} {between}".strip())
    lasting = duration(float(time[-1] - time[0])) if len(time) > 1 else "no time"
    return f"{channel.label} over {lasting}: {'; '.join(texts)}"
