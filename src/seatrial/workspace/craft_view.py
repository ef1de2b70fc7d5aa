"""The view of craft and model: every number with where it comes from, what is estimated, and what may be estimated."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from tomlkit.items import AoT, Table

from seatrial import api
from seatrial.core.text.words import printable
from seatrial.core.values import InputError
from seatrial.core.values.files import parse_toml
from seatrial.data.draft.draft_text import ASSUMED
from seatrial.data.trial.load import parse_tables, trial_of_tables
from seatrial.data.trial.plausibility import ESTIMATED
from seatrial.workspace.trial_document import BY_HAND, parsed_document

_LONGEST = 600  # letters of a comment; chosen
_TABLES = (("ship",), ("model",), ("model", "fixed"), ("sensors",), ("excitation",), ("estimate",), ("noise",))


def craft_view(text: str, path: Path) -> dict[str, Any]:
    """Return the tables of craft, model and estimate with the reason of each value, and the model's parameters.

    A text that names no model has no parameters; `problem` says what is missing.
    """
    document: Mapping[str, Any] = parsed_document(text)
    thrusters = [("thruster", k) for k in range(len(document.get("thruster", ())))]
    waves = [("records", k, "waves") for k in range(len(document.get("records", ())))]
    tables = [{"place": place, "rows": _rows(document, place)} for place in (*_TABLES, *thrusters, *waves)]
    problem, parameters = "", list[dict[str, Any]]()
    name = str(document.get("model", {}).get("name", ""))
    try:
        trial = trial_of_tables(parse_tables(parse_toml(text), path), path)
        parameters = [
            {
                "name": p.name, "meaning": p.meaning, "unit": "" if p.unit == "1" else p.unit,
                "value": None if p.value != p.value else float(p.value), "free": p.free,
                "source": printable(p.source, _LONGEST),
            }
            for p in trial.model.parameters
        ]  # fmt: skip
    except (InputError, ValueError) as error:
        problem = printable(str(error), _LONGEST)
    models = [{"name": model.name, "about": ", ".join(model.states)} for model in api.list_models()]
    return {"tables": tables, "model": name, "parameters": parameters, "models": models, "problem": problem}


def _rows(document: Mapping[str, Any], place: Sequence[str | int]) -> list[dict[str, Any]]:
    table: Any = document
    for key in place:
        table = table[key] if isinstance(key, int) else table.get(key, {})
    return [_row(key, value) for key, value in table.items() if not isinstance(value, Table | AoT)]


def _row(key: str, value: Any) -> dict[str, Any]:
    reason = value.trivia.comment.lstrip("# ") if hasattr(value, "trivia") else ""
    marks = {ESTIMATED: "estimated", ASSUMED: "assumed", BY_HAND: "by hand"}
    standing = next((word for mark, word in marks.items() if reason.startswith(mark)), "stated")
    for mark in marks:
        reason = reason.removeprefix(mark).lstrip(":; ")
    plain = value.unwrap() if hasattr(value, "unwrap") else value
    return {"key": key, "value": plain, "reason": printable(reason, _LONGEST), "standing": standing}
