"""The text of a page: a template filled, its figures' colours for dark screens, and what the page may run."""

import base64
import hashlib
import json
import re
from collections.abc import Mapping
from functools import cache
from typing import TYPE_CHECKING

from markupsafe import Markup

from seatrial.core.figures.night import night_colour, night_rules
from seatrial.core.text.numbers import duration, significant
from seatrial.reporting.mathml import inline, pieces

if TYPE_CHECKING:
    from jinja2 import Environment

_COLOUR = re.compile(r'(?:fill|stroke)="(#[0-9a-f]{6}(?:[0-9a-f]{2})?)"')
_ANY_COLOUR = re.compile(r'"(#[0-9a-f]{6})(?:[0-9a-f]{2})?"')
_STYLE, _SCRIPT = re.compile(r"<style>(.*?)</style>", re.DOTALL), re.compile(r"<script>(.*?)</script>", re.DOTALL)
# places of a template that are filled once its text is known
_POLICY, _NIGHT_RULES = "POLICY-OF-THIS-PAGE", "/* NIGHT-RULES */"
_PLOT_SCRIPTS, _NIGHT_COLOURS = "<!-- PLOT-SCRIPTS -->", "NIGHT-COLOURS"


def page_text(template: str, context: Mapping[str, object]) -> str:
    """Return the page of a template: self-contained, nothing but its own styles and scripts may take effect.

    The Content-Security-Policy names styles and scripts by their SHA-256 (W3C, Content Security Policy Level 3, 2.3.1).
    """
    text = environment().get_template(template).render(context)
    has_series = 'class="series"' in text
    text = text.replace(_PLOT_SCRIPTS, environment().get_template("plots.html").render() if has_series else "", 1)
    colours = sorted(set(_ANY_COLOUR.findall(text))) if has_series else []
    text = text.replace(_NIGHT_COLOURS, json.dumps({c: night_colour(c) for c in colours}), 1)
    text = text.replace(_NIGHT_RULES, night_rules(_COLOUR.findall(text)), 1)
    return text.replace(_POLICY, _policy(text), 1)


def _policy(text: str) -> str:
    styles, scripts = (" ".join(map(_digest, pattern.findall(text))) for pattern in (_STYLE, _SCRIPT))
    return f"default-src 'none'; img-src data:; style-src {styles}; script-src {scripts}"


def _digest(text: str) -> str:
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


@cache
def environment() -> "Environment":
    """Return the templates with everything escaped by default, and the filters they use."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    from seatrial.reporting.compiled_templates import CompiledTemplates

    templates = Environment(
        loader=PackageLoader("seatrial.reporting"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        bytecode_cache=CompiledTemplates(),
    )
    templates.filters["duration"] = duration
    templates.filters["significant"] = significant
    templates.filters["math"] = lambda latex: Markup(inline(latex))
    templates.filters["breakable"] = lambda latex: Markup("".join(pieces(latex)))
    return templates
