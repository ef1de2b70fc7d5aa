"""What is exported: a model file, where it comes from, and how its quantities are described to another tool."""

import re
from collections.abc import Mapping
from dataclasses import dataclass

from seatrial.core.equations import Model
from seatrial.core.results import offsets_text
from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, InputError, Record
from seatrial.data.folder.model_file import CONVENTIONS, ModelFile

_LONGEST_NOTE = 200  # letters of a text from a file that a comment repeats; chosen
_HASH_DIGITS = 16  # of a SHA-256 that a comment repeats: no two files of a user are alike in 64 bits; chosen
# C99, section 6.4.1
_C_KEYWORDS = frozenset(
    [
        "auto",
        "break",
        "case",
        "char",
        "const",
        "continue",
        "default",
        "do",
        "double",
        "else",
        "enum",
        "extern",
        "float",
        "for",
        "goto",
        "if",
        "inline",
        "int",
        "long",
        "register",
        "restrict",
        "return",
        "short",
        "signed",
        "sizeof",
        "static",
        "struct",
        "switch",
        "typedef",
        "union",
        "unsigned",
        "void",
        "volatile",
        "while",
    ]
)


@dataclass(frozen=True, eq=False)
class ExportSource:
    """A model file to be exported.

    Attributes:
        origin: path of the model file, or what the model is called.
        date: of the export, year-month-day.
        gains: of a tuned autopilot, name -> value; None: the target that needs gains chooses them.
        runs: the training runs, where the result of the fit is at hand.
    """

    file: ModelFile
    origin: str
    date: str
    gains: Mapping[str, float] | None = None
    runs: tuple[Record, ...] = ()

    @property
    def model(self) -> Model:
        """The model."""
        return self.file.model


@dataclass(frozen=True)
class Variable:
    """A state, input, output or parameter as another tool shows it."""

    name: str
    unit: str
    note: str


def plain(text: str) -> str:
    """Return a text from a file on one line, without control characters, fit for the comments of any language."""
    one_line = printable(" ".join(text.split()), _LONGEST_NOTE)
    safe = one_line.replace("*/", "* /").replace("/*", "/ *").replace("--", "- -").replace("\\", "/")
    return safe.replace("??", "? ?").replace('"""', "'")


def state_variables(model: Model) -> tuple[Variable, ...]:
    """Return the states in order with unit, frame and sign."""
    return tuple(_variable(name, "") for name in model.states)


def input_variables(model: Model) -> tuple[Variable, ...]:
    """Return the inputs in order with unit and the sign that the model gives them."""
    return tuple(_variable(i.name, i.direction) for i in model.inputs)


def output_variables(model: Model) -> tuple[Variable, ...]:
    """Return the measurable outputs in order."""
    return tuple(
        _variable(b.name, "") if b.name in NOTATION else Variable(b.name, b.unit, plain(b.source))
        for b in model.equations.output_bindings
    )


def parameter_variables(model: Model) -> tuple[Variable, ...]:
    """Return the parameters in order with unit and meaning."""
    return tuple(Variable(p.name, p.unit, plain(p.meaning or p.source)) for p in model.parameters)


def _variable(name: str, direction: str) -> Variable:
    if name not in NOTATION:
        return Variable(name, "", plain(f"as model '{name}' defines it" if not direction else "input of the model"))
    quantity = NOTATION[name]
    positive = direction or quantity.positive
    sign = "" if positive == "none" else f", positive {positive}"
    frame = "" if quantity.frame == "none" else f", {quantity.frame}-fixed"
    return Variable(name, quantity.unit, f"{quantity.meaning}{frame}{sign}")


def provenance_lines(source: ExportSource) -> list[str]:
    """Return what every exported file says: model, ship, data, method, date, conventions, each on a line."""
    file, model = source.file, source.model
    digits = model.equation_hash[:_HASH_DIGITS]
    lines = [
        f"Model '{plain(model.name)}' ({plain(model.equations.source)}), equations {digits}.",
        f"Exported {source.date} by seatrial from {plain(source.origin)}; do not edit.",
    ]
    if file.ship is not None:
        lines.append(f"Ship: {plain(file.ship.name)}, scale 1:{file.ship.scale:g}; {plain(file.ship.source)}")
    if file.provenance.method:
        lines.append(f"Method: {plain(file.provenance.method)}")
    if of_inputs := [offset for offset in file.offsets if offset.is_of_input]:
        lines.append(f"Inputs are true values; in logs the fit found {plain(offsets_text(of_inputs, None))}.")
    lines += [f"Data: {plain(r.name)} ({r.role}), SHA-256 {r.sha256[:_HASH_DIGITS]}" for r in file.provenance.records]
    versions = file.provenance.versions or {}
    if versions:
        lines.append("Versions: " + ", ".join(f"{plain(k)} {plain(str(v))}" for k, v in sorted(versions.items())))
    return [*lines, f"Conventions: {CONVENTIONS}."]


def require_values(source: ExportSource) -> None:
    """Accept a model whose parameters all have values.

    Raises:
        InputError: one has none.
    """
    missing = source.model.parameters.missing
    if missing:
        raise InputError(f"model '{source.model.name}' has no value for {', '.join(missing)}; identify it first")


def require_identifiers(source: ExportSource, name: str) -> None:
    """Accept names that are identifiers of C, and so of the other languages.

    Raises:
        InputError: the name of the file, or a symbol of the model, is none.
    """
    if not _is_c_identifier(name):
        cleaned = re.sub(r"[^A-Za-z0-9_]", "_", name)
        example = cleaned if _is_c_identifier(cleaned) else f"ship_{cleaned}"
        raise InputError(
            f"'{name}', the name that the path gives, is no C identifier; use letters, digits and underscores, such as "
            f"'{example}'"
        )
    model = source.model
    for symbol in (*model.states, *model.input_names, *model.outputs, *model.parameters.names):
        if not _is_c_identifier(symbol):
            raise InputError(f"'{symbol}' of model '{model.name}' is no C identifier; rename it in the model")


def _is_c_identifier(name: str) -> bool:
    return re.fullmatch(r"[A-Za-z][A-Za-z0-9_]*", name) is not None and name not in _C_KEYWORDS
