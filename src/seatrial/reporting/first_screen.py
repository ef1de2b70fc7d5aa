"""What every page answers first: a sentence with its number, a picture, a short table."""

from dataclasses import dataclass, field

from markupsafe import Markup


@dataclass(frozen=True)
class KeyFact:
    """A row of the table at the top.

    Attributes:
        section: key of the section that says more; empty: none.
        is_good: what the mark at the row says; None: neither good nor bad.
    """

    name: str
    text: str
    section: str = ""
    is_good: bool | None = None


@dataclass(frozen=True)
class FirstScreen:
    """A verdict, its table, and a picture with its caption; an empty picture or lead is not shown.

    lead: what the result means to those who operate the craft, in a sentence.
    gains: symbols and values of a controller, under `gains_title`.
    """

    verdict: str
    facts: tuple[KeyFact, ...]
    figure: Markup = field(default_factory=Markup)
    caption: str = ""
    lead: str = ""
    gains_title: str = ""
    gains: tuple[tuple[str | Markup, str], ...] = ()
