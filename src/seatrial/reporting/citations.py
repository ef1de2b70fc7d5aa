"""Publications named in sources, numbered in order of appearance."""

import html
import re

from markupsafe import Markup

_CITATION = re.compile(
    r"(?P<key>[A-Z][\w'’-]+(?: (?:&|and) [A-Z][\w'’-]+| et al\.)? (?:19|20)\d\d)"
    r"(?P<place>, (?:doi 10\.[^\s,;)]+|[A-Z][A-Za-z. ]+? \d+, \d+-\d+))?"
)
_DOI = re.compile(r"doi (10\.[^\s,;)]+)")


class Citations:
    """Numbers publications as texts are marked; the list is complete once everything has been marked."""

    def __init__(self) -> None:
        self._publications: dict[str, str] = {}

    def mark(self, text: str) -> Markup:
        """Return the text, escaped, with ``[k]`` in place of every publication in it."""
        parts, at = [], 0
        for match in _CITATION.finditer(text):
            parts.append(html.escape(text[at : match.start()]))
            parts.append(self._link(match["key"], match[0]))
            at = match.end()
        return Markup("".join([*parts, html.escape(text[at:])]))

    def _link(self, key: str, text: str) -> str:
        if len(text) > len(self._publications.get(key, "")):
            self._publications[key] = text
        number = list(self._publications).index(key) + 1
        return (
            f'<a class="cite" href="#reference-{number}" title="{html.escape(self._publications[key])}">[{number}]</a>'
        )

    def entries(self) -> list[Markup]:
        """Return the publications in order, DOIs as links."""
        linked = r'<a href="https://doi.org/\1">doi:\1</a>'
        return [Markup(_DOI.sub(linked, html.escape(text.replace("-", "\u2013") if "doi" not in text else text)))
                for text in self._publications.values()]  # fmt: skip
