"""What is exported: a model file, how its quantities are described, and how far they leave the training runs."""

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

from seatrial.core.equations import Binding, Model
from seatrial.core.equations.bindings import stored
from seatrial.core.results import offsets_text
from seatrial.core.text.words import printable
from seatrial.core.values import NOTATION, InputError, Record
from seatrial.data.folder.model_file import CONVENTIONS, ModelFile
from seatrial.estimation.information.extrapolation import COMMAND, COMMAND_GAIN, NEGLIGIBLE, REST_SHARE
from seatrial.physics.models.thruster_layout import Thruster, layout_of

if TYPE_CHECKING:
    import sympy as sp
    from jinja2 import Environment


# Templates of exported files; numbers are written so that they read back to the last bit.


@cache
def _environment() -> "Environment":
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader("seatrial.exporting"),
        autoescape=lambda name: name is not None and name.endswith(".xml"),
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def rendered(template: str, **values: Any) -> bytes:
    """Return a template of this package filled in, as UTF-8; XML is escaped."""
    return _environment().get_template(template).render(**values).encode()


def stored_text(key: Sequence[object], write: Callable[[], dict[str, list[str]]]) -> dict[str, list[str]]:
    """Return the lines of generated functions by name, from the compile cache where it holds them.

    key: what decides the text, with the same `repr` in every process.
    """
    return stored("exported", key, write, (Path(__file__).parent,))


# What is exported: a model file, where it comes from, and how its quantities are described to another tool.

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


# How far a state and an input leave the range of the training runs, as an equation that the printers write.

RANGE_USE = "range_use"
"""Name of the output: at most 1 within the identified range."""
_LABELS = {
    "slowest": ("speed", ">=", "m/s"), "fastest": ("speed", "<=", "m/s"), "drift": ("|drift|", "<=", "rad"),
    "yaw_rate": ("|yaw rate|", "<=", "rad/s"), "rudder": ("|rudder|", "<=", "rad"),
}  # fmt: skip


def identified_range(source: ExportSource) -> dict[str, float]:
    """Return the limits that the model file states and the model can leave: as in `motion_envelope`, SI."""
    basis, model = source.file.interval_basis, source.model
    symbols = {*model.states, *model.input_names}
    needed = {"yaw_rate": {"r"}, "drift": {"u", "v"}, "rudder": {"delta"}, "fastest": {"u"}, "slowest": {"u"}}
    envelope = {} if basis is None else basis.training_envelope
    limits = {n: envelope[n] for n in needed if n in envelope and envelope[n] > NEGLIGIBLE[n] and needed[n] <= symbols}
    limits = {n: v for n, v in limits.items() if n != "slowest" or "fastest" in limits}
    if not {"slowest", "fastest"} <= set(limits):
        return limits
    kinds = [f"{COMMAND}{t.name} {side}" for t in _thrusters(source) for side in ("ahead", "astern")]
    return limits | {name: envelope[name] for name in kinds if name in envelope}


def _thrusters(source: ExportSource) -> tuple[Thruster, ...]:
    return layout_of(source.model).thrusters if source.model.has_thrusters else ()


def range_text(source: ExportSource) -> str:
    """Return the range as a sentence."""
    limits = identified_range(source)
    if not limits:
        return "Identified range: the model file states none."
    parts = [f"{label} {sign} {limits[n]:.4g} {unit}" for n, (label, sign, unit) in _LABELS.items() if n in limits]
    parts += [f"{plain(n)} <= {100.0 * v:.3g} %" for n, v in limits.items() if n.startswith(COMMAND)]
    return f"Identified range: {', '.join(parts)}."


def range_use(source: ExportSource) -> Binding | None:
    """Return the equation of `range_use`; None where the model file states no range."""
    import sympy as sp

    limits = identified_range(source)
    if not limits:
        return None
    u, v, r, delta = (sp.Symbol(name, real=True) for name in ("u", "v", "r", "delta"))
    speed = sp.sqrt(u**2 + v**2) if "v" in source.model.states else sp.Abs(u)
    rest = max(REST_SHARE * limits.get("fastest", 0.0), NEGLIGIBLE["slowest"])
    ratios: dict[str, sp.Expr] = {
        "yaw_rate": sp.Abs(r), "drift": sp.Abs(sp.atan2(-v, u)), "rudder": sp.Abs(delta), "fastest": speed,
    }  # fmt: skip
    scaled = [ratios[n] / sp.Float(limits[n]) for n in limits if n in ratios]
    for thruster in _thrusters(source):
        share = _command_share(thruster)
        for side, sign in (("ahead", 1), ("astern", -1)):
            name = f"{COMMAND}{thruster.name} {side}"
            if name in limits:
                beyond: sp.Expr = sp.Max(sign * share - sp.Float(limits[name]), 0)
                scaled.append(sp.Add(1, sp.Float(COMMAND_GAIN) * beyond))
    if "slowest" in limits:
        scaled.append(sp.Float(max(limits["slowest"], rest)) / sp.Max(speed, sp.Float(rest)))
    return Binding.from_expression(RANGE_USE, sp.Max(*scaled), "training runs")


def _command_share(thruster: Thruster) -> "sp.Expr":
    """Return a thruster's share of full command; reading at rest and span are parameters of the model."""
    import sympy as sp

    zero, span = (sp.Symbol(f"{name}_{thruster.name}", real=True) for name in ("zero", "span"))
    return (sp.Symbol(thruster.command.channel, real=True) - zero) / span


# What a target of an export is, and what it returns.


@dataclass(frozen=True)
class Export:
    """Files of one export and what a user has to know of them.

    Attributes:
        files: name -> content; one file is written to the path itself, several into a folder of that name.
        notes: sentences to print: prices of a projection, what could not be done.
    """

    files: Mapping[str, bytes]
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class Target:
    """A tool that models are exported to.

    Attributes:
        meaning: what is written, in a phrase.
        suffix: of the file; empty where a folder is written.
        unsuitable: returns why the target has no place for a model; empty where it has one.
        export: returns the files; its second argument is the name that the path gives.
        takes_gains: whether gains of a tuned autopilot have a place in it.
        takes_runs: whether it is fitted to the training runs.
    """

    name: str
    meaning: str
    suffix: str
    unsuitable: Callable[[ExportSource], str]
    export: Callable[[ExportSource, str], Export] = field(repr=False)
    takes_gains: bool = False
    takes_runs: bool = False
