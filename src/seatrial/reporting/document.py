"""The text of a page: a template filled, with the scripts that draw its time series where it has any."""

import json
import re
from collections.abc import Mapping, Sequence
from functools import cache
from typing import TYPE_CHECKING

from markupsafe import Markup

from seatrial.core.figures.svg_text import night_colour
from seatrial.core.pages import shell
from seatrial.core.text.numbers import duration, significant
from seatrial.reporting.mathml import inline, pieces
from seatrial.reporting.section import FirstScreen, Section

if TYPE_CHECKING:
    from jinja2 import Environment

_ANY_COLOUR = re.compile(r'"(#[0-9a-f]{6})(?:[0-9a-f]{2})?"')
_UNREAD = re.compile(r"^ *(?://.*\n)?", re.MULTILINE)  # indentation of a script, and its lines of comment
# places of a template that are filled once its text is known
_PLOT_SCRIPTS, _NIGHT_COLOURS = "<!-- PLOT-SCRIPTS -->", "NIGHT-COLOURS"


def page_text(template: str, context: Mapping[str, object]) -> str:
    """Return the page of a template: self-contained, nothing but its own styles and scripts may take effect."""
    text = environment().get_template(template).render(context)
    has_series = 'class="series"' in text
    text = text.replace(_PLOT_SCRIPTS, environment().get_template("plots.html").render() if has_series else "", 1)
    colours = sorted(set(_ANY_COLOUR.findall(text))) if has_series else []
    return shell.with_policy(text.replace(_NIGHT_COLOURS, json.dumps({c: night_colour(c) for c in colours}), 1))


def chapters_page(
    kind: str, heading: str, screen: FirstScreen, chapters: Sequence[Section], *, title: str = "", question: str = "",
    about: Sequence[str] = (),
) -> str:  # fmt: skip
    """Return the page of a result: what it answers first, then its chapters with their contents.

    kind: of result, above the heading; title: of the window, empty: the heading; question: that the result answers;
    about: on what it rests, in a line.
    """
    context = {
        "kind": kind, "heading": heading, "screen": screen, "chapters": chapters, "title": title or heading,
        "question": question, "about": about,
    }  # fmt: skip
    return page_text("page.html", context)


@cache
def environment() -> "Environment":
    """Return the templates of reports on those of the shell, and the filters they use."""
    templates = shell.environment("seatrial.reporting")
    templates.filters["duration"] = duration
    templates.filters["significant"] = significant
    templates.filters["run_only"] = lambda script: _UNREAD.sub("", script)
    templates.filters["math"] = lambda latex: Markup(inline(latex))
    templates.filters["breakable"] = lambda latex: Markup("".join(pieces(latex)))
    return templates
