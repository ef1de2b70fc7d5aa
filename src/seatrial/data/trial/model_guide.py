"""What a model needs, what is filled from where, and the tables of a trial file to begin with."""

from collections.abc import Mapping
from dataclasses import dataclass

from seatrial.core.equations import Model
from seatrial.core.values import Parameter, Ship
from seatrial.data.trial.literature import USUAL_PROPELLER, LiteraturePrior, literature_priors
from seatrial.physics.models import model_named
from seatrial.physics.models.published import kvlcc2_l7
from seatrial.physics.simulate.channels import ZERO_BY_DEFAULT

# formulas that fill what nobody tested, in the order in which later ones win
_SOURCES: Mapping[str, tuple[str, ...]] = {
    "mmg": ("yoshimura", "zhou", "interaction", "propulsion", "displacement"),
}
_FORM = ("L", "B", "d", "C_b", "D_P", "H_R", "A_R")  # what the formulas take, and the model besides
_PRIOR_PERCENT = (
    50  # of a coefficient whose scatter is not known; ours: linear ones are good to 25, cubic to their order
)
_INTERACTION = ("t_P", "w_P0", "gamma_R_plus", "gamma_R_minus")
_MEANINGS = {
    "L": "m, between perpendiculars", "B": "m, breadth", "d": "m, draught", "C_b": "block coefficient",
    "H_R": "m, span of the rudder", "A_R": "m^2, area of the rudder",
}  # fmt: skip


@dataclass(frozen=True)
class FilledValue:
    """A parameter that nobody needs to state: where its value comes from, and how far that may be wrong.

    deviation: standard deviation of the prior; 0: `prior_sd_percent` of the value, or none where it is fixed.
    """

    name: str
    source: str
    deviation: float


@dataclass(frozen=True)
class ModelGuide:
    """What a model needs.

    Attributes:
        name, source: of its equations.
        inputs: channels that act on the model.
        observables: channels that are compared with it, of which one is needed.
        optional_inputs: those of the inputs that are zero where they are not recorded.
        needed: particulars to state under `[ship]` -> unit and meaning.
        free: parameters that are estimated by default.
        filled: parameters with a value by formula, or by default in the model.
        trial: the tables `[ship]`, `[model]` of a trial file to fill in.
    """

    name: str
    source: str
    inputs: tuple[str, ...]
    optional_inputs: tuple[str, ...]
    observables: tuple[str, ...]
    needed: Mapping[str, str]
    free: tuple[str, ...]
    filled: tuple[FilledValue, ...]
    trial: str


def model_guide(name: str) -> ModelGuide:
    """Return what a built-in or installed model needs and what is filled from where.

    Raises:
        InputError: there is no such model; the nearest name is given.
    """
    model, sources = model_named(name), _SOURCES.get(name, ())
    priors = literature_priors(sources, _example_ship(), name) if sources else {}
    needed = _needed(model, priors)
    free = tuple(p.name for p in model.parameters.free)
    return ModelGuide(
        name, model.equations.source, model.input_names,
        tuple(name for name in model.input_names if name in ZERO_BY_DEFAULT), model.observables, needed, free,
        tuple(_filled(model, priors)), _trial_tables(model, sources, needed, free),
    )  # fmt: skip


def _example_ship() -> Ship:
    """A ship with what the formulas take and nothing else: which parameters they fill does not depend on it."""
    known = kvlcc2_l7().ship
    return Ship(known.name, {name: known.particulars[name] for name in _FORM})


def _needed(model: Model, priors: Mapping[str, LiteraturePrior]) -> dict[str, str]:
    missing = [p for p in model.parameters if p.name in model.parameters.missing and p.name not in priors]
    words = {p.name: _words(p) for p in missing}
    form = {name: _MEANINGS[name] for name in _FORM if name in _MEANINGS} if priors else {}
    return {"L": _MEANINGS["L"]} | form | {name: text for name, text in words.items() if name not in form}


def _words(parameter: Parameter) -> str:
    return ", ".join(part for part in (parameter.unit if parameter.unit != "1" else "", parameter.meaning) if part)


def _filled(model: Model, priors: Mapping[str, LiteraturePrior]) -> list[FilledValue]:
    by_formula = [FilledValue(n, one.source, one.deviation) for n, one in priors.items() if n in model.parameters]
    stated = {"L", *priors, *model.parameters.missing}
    fixed = [p for p in model.parameters if p.name not in stated]
    return by_formula + [FilledValue(p.name, _stated(p), 0.0) for p in fixed]


def _stated(parameter: Parameter) -> str:
    """The default of a model and its origin; of a coefficient that starts at zero only that."""
    origin = f"default of the model ({parameter.source})" if parameter.source else "default of the model"
    return "starts at zero" if parameter.value == 0.0 else origin


def _trial_tables(model: Model, sources: tuple[str, ...], needed: Mapping[str, str], free: tuple[str, ...]) -> str:
    lines = ["[ship]", 'name = "..."', *(_particular(name, text) for name, text in needed.items())]
    if sources:
        usual = USUAL_PROPELLER.items()
        lines += [f"# {name} = {value:g}    # of the propeller, where it is known" for name, value in usual]
    lines += ["", "[model]", f'name = "{model.name}"']
    if sources:
        lines += [
            f"priors_from = [{_quoted_list(sources)}]",
            f"prior_sd_percent = {_PRIOR_PERCENT}    # of coefficients whose scatter is not known",
            f"free = [{_quoted_list((*free, *_INTERACTION))}]",
        ]
    if model.name == "thrusters":
        lines += [
            "", "[[thruster]]    # one for each thruster", 'name = "port"', "x = -0.5    # m forward of the origin",
            "y = -0.3    # m to starboard", 'command = { channel = "command_1", unit = "1" }',
        ]  # fmt: skip
    return "\n".join(lines) + "\n"


def _particular(name: str, text: str) -> str:
    """A line to fill in; the length, which every trial needs, is no comment, and zero is refused until it is stated."""
    return f"{name} = 0.0    # {text}" if name == "L" else f"# {name} = 0.0    # {text}; required"


def _quoted_list(names: tuple[str, ...]) -> str:
    return ", ".join(f'"{name}"' for name in names)
