"""All records of a fit as small multiples: channels over time, and tracks."""

from collections.abc import Sequence

from seatrial.core.figures.chart import WIDTH, Chart, Panel, Region
from seatrial.core.figures.run import Track, is_slender, strip_height, track_panel
from seatrial.core.text.words import common_prefix
from seatrial.core.values import Record
from seatrial.core.values.record_chart import PLAIN, has_track, record_track

# channels and records of one figure at most
MAX_COLUMNS, MAX_ROWS = 8, 16
# tracks in a row: square ones, and strips; free room above, between and beside them [px]
COLUMNS, STRIP_COLUMNS = 4, 2
TOP, ROW_GAP, LEFT, RIGHT = 22.0, 56.0, 52.0, 12.0  # px, chosen
MIN_STRIP = 44.0  # px, chosen
SMALL = 8.5  # px, chosen


def track_overview(records: Sequence[Record], length: float) -> Chart | None:
    """Return small multiples of all tracks, strips first; None where no record has positions.

    Args:
        length: of the ship [m].
    """
    prefix = common_prefix([r.name for r in records])
    named = [(r.name.removeprefix(prefix), record_track(r, PLAIN)) for r in records if has_track(r)]
    strips = [(name, track) for name, track in named if is_slender([track])]
    squares = [(name, track) for name, track in named if not is_slender([track])]
    panels = _track_rows(strips, length, 0.0, STRIP_COLUMNS)
    bottom = panels[-1].box.bottom + ROW_GAP - TOP if panels else 0.0
    panels += _track_rows(squares, length, bottom, COLUMNS)
    return Chart("tracks of the records", tuple(panels)) if panels else None


def _track_rows(tracks: Sequence[tuple[str, Track]], length: float, top: float, columns: int) -> list[Panel]:
    """Rows of tracks below `top`, strips as high as the widest of their row needs."""
    inner, panels = WIDTH / columns - LEFT - RIGHT, []
    for k in range(0, len(tracks), columns):
        row = tracks[k : k + columns]
        is_strip = columns == STRIP_COLUMNS
        # px, chosen
        height = max(MIN_STRIP, *(strip_height([t], inner, 0.06 * inner) for _, t in row)) if is_strip else inner
        for j, (name, track) in enumerate(row):
            box = Region(WIDTH / columns * j + LEFT, top + TOP, inner, height)
            panels.append(track_panel([track], length, box, has_names=False, x_ticks=4, y_ticks=2 if is_strip else 4,
                                      title=name))  # fmt: skip
        top += height + ROW_GAP
    return panels
