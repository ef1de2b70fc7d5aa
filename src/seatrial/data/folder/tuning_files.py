"""A tuned controller in files that other programs read: gains as TOML, the loop for MATLAB, the schedule as CSV."""

import keyword
import math
import re
import tomllib
from functools import reduce
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
import tomli_w
from numpy.typing import NDArray

from seatrial.core.results.tuning import Component, Controller, OperatingPoint, Tuning
from seatrial.core.values import InputError
from seatrial.data.folder.orders import channel_display_unit

FORMAT = 1
# the text that begins a MAT-file is 116 bytes long and names no date here, so that the same loop gives the same bytes
_HEADER = b"MATLAB 5.0 MAT-file, a feedback loop written by seatrial".ljust(116)
_RESERVED = {"end", "function", "otherwise", "switch", "case", "parfor", "spmd", "persistent", "catch", *keyword.kwlist}
Rational = tuple[NDArray[Any], NDArray[Any]]


def gains_toml(tuning: Tuning) -> str:
    """``gains.toml``: chosen gains, what they were tuned for and keep, their margins, the schedule if there is one.

    Angles are in degrees where the key says so; what is infinite (no limit, any margin) is left out.
    """
    table: dict[str, Any] = {
        "format": FORMAT,
        "controller": {"name": tuning.name, "plant": tuning.plant, "output": tuning.output,
                       "actuator": tuning.actuator, "seas": list(tuning.seas)},
        "gains": _finite_numbers(tuning.chosen.gains),
        "margins": _margin_table(tuning.chosen),
        "constraints": _constraint_table(tuning),
        "provenance": {"seed": tuning.seed, "versions": tuning.versions, "violated": list(tuning.chosen.violated)},
    }  # fmt: skip
    if tuning.schedule:
        table["schedule"] = [_schedule_entry(slot) for slot in tuning.schedule]
    return tomli_w.dumps(table)


def read_gains(path: str | Path) -> dict[str, float]:
    """The gains of a ``gains.toml``, name -> value to the last bit.

    Raises:
        InputError: the file cannot be read, is no TOML, or has no table [gains] of finite numbers.
    """
    try:
        table = tomllib.loads(Path(path).read_text(encoding="utf-8"))
    except OSError as error:
        raise InputError(f"'{path}' cannot be read ({error.strerror}); give a gains.toml of 'seatrial tune'") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise InputError(f"'{path}' is no TOML ({error}); give a gains.toml of 'seatrial tune'") from None
    gains = table.get("gains")
    if not isinstance(gains, dict) or not gains:
        raise InputError(f"'{path}' has no table [gains] with a line for each gain, such as KP = 11.053")
    for name, value in gains.items():
        if isinstance(value, bool) or not isinstance(value, (int, float)) or not math.isfinite(value):
            raise InputError(f"'{path}': gain {name} = {value!r} is no finite number; write one")
    return {name: float(value) for name, value in gains.items()}


def schedule_csv(tuning: Tuning) -> str:
    """The schedule as CSV, a line for each condition; empty without one."""
    if not tuning.schedule:
        return ""
    first = tuning.schedule[0]
    heads = [
        "U [m/s]",
        "heading [deg]",
        "height [m]",
        *first.gains,
        "cost",
        *(f"cost {name}" for name in first.baseline_costs),
        "Ms",
        "saturation",
        "feasible",
    ]
    rows = [
        [
            _number_text(x)
            for x in (
                s.U,
                math.degrees(s.beta),
                s.height,
                *s.gains.values(),
                s.cost,
                *s.baseline_costs.values(),
                s.Ms,
                s.saturation,
            )
        ]
        + ["yes" if s.is_feasible else "no"]
        for s in tuning.schedule
    ]
    return "\n".join(",".join(cells) for cells in [[_csv_cell(h) for h in heads], *rows]) + "\n"


def loop_mat(tuning: Tuning) -> bytes:
    """The chosen loop as a MAT-file of version 5; the same tuning gives the same bytes.

    A struct for each block (``num``, ``den``, ``role``, ``name``, ``gain``, ``value``), ``gains``, and where there are
    terms ``controller_num``, ``controller_den`` (K, from the output to the actuator, which moves by minus K y) and
    ``open_loop_num``, ``open_loop_den`` (L = P K). Powers of s fall, angles are radians.
    """
    from scipy.io import savemat

    gains = tuning.chosen.gains
    content: dict[str, Any] = {"gains": {_matlab_name(name): value for name, value in gains.items()}}
    for name, component in _matlab_names(tuning.components, {*content, *_POLYNOMIALS}).items():
        content[name] = {
            "num": np.array(component.num), "den": np.array(component.den), "role": component.role,
            "name": component.name, "gain": component.gain,
            "value": gains.get(component.gain, 1.0) if component.gain else 1.0,
        }  # fmt: skip
    if any(c.role == "term" for c in tuning.components):
        controller, loop = controller_polynomials(tuning), open_loop_polynomials(tuning)
        content |= dict(zip(_POLYNOMIALS, (*controller, *loop), strict=True))
    made = BytesIO()
    savemat(made, content, format="5", long_field_names=True, oned_as="row")  # type: ignore[arg-type]
    return _HEADER + made.getvalue()[len(_HEADER) :]


_POLYNOMIALS = ("controller_num", "controller_den", "open_loop_num", "open_loop_den")


def controller_polynomials(tuning: Tuning) -> Rational:
    """K(s) = sensors * (sum of gain_i term_i) * filters * servo as num and den, highest power first.

    Raises:
        InputError: a term's gain is not among the chosen ones.
    """
    terms = [c for c in tuning.components if c.role == "term"]
    dens = list(dict.fromkeys(c.den for c in terms))
    parallel = np.zeros(1)
    for term in terms:
        if term.gain not in tuning.chosen.gains:
            raise InputError(f"term '{term.name}' is multiplied by '{term.gain}', which is none of the chosen gains")
        others = (den for den in dens if den != term.den)
        own = reduce(np.polymul, others, tuning.chosen.gains[term.gain] * np.array(term.num))
        parallel = np.polyadd(parallel, np.atleast_1d(own))
    sum_of_terms = np.atleast_1d(parallel), reduce(np.polymul, dens, np.ones(1))
    return _product(sum_of_terms, tuple(c for c in tuning.components if c.role in ("sensor", "filter", "servo")))


def open_loop_polynomials(tuning: Tuning) -> Rational:
    """L(s) = P(s) K(s) as num and den; the loop is closed negatively."""
    return _product(controller_polynomials(tuning), tuple(c for c in tuning.components if c.role == "plant"))


def _product(first: Rational, components: tuple[Component, ...]) -> Rational:
    num, den = first
    for c in components:
        num, den = np.polymul(num, c.num), np.polymul(den, c.den)
    return num, den


def _matlab_names(components: tuple[Component, ...], reserved: set[str]) -> dict[str, Component]:
    """Each block under a name of its own that MATLAB takes for a variable."""
    made: dict[str, Component] = {}
    for c in components:
        word = stem = _matlab_name(c.name if c.name.startswith(c.role) else f"{c.role}_{c.name}")
        count = 2
        while word in made or word in reserved:
            word, count = f"{stem}_{count}", count + 1
        made[word] = c
    return made


def _matlab_name(name: str) -> str:
    """Letters, digits and underscores, a letter first, at most 60."""
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:60] or "unnamed"
    return f"x_{word}" if not word[0].isalpha() else f"{word}_" if word.lower() in _RESERVED else word


def _finite_numbers(values: dict[str, float]) -> dict[str, float]:
    """Finite numbers only, none of them NumPy's."""
    return {name: float(value) for name, value in values.items() if math.isfinite(value)}


def _margin_table(c: Controller) -> dict[str, float]:
    return _finite_numbers({
        "Ms": c.Ms,
        "gain_margin": c.gain_margin,
        "phase_margin_deg": math.degrees(c.phase_margin),
        "delay_margin_s": c.delay_margin,
        "damping_ratio": c.damping,
        "reduction": c.reduction,
        "saturation": c.saturation,
        "rate_saturation": c.rate_saturation,
    })  # fmt: skip


def _constraint_table(tuning: Tuning) -> dict[str, float]:
    """The restrictions, keys of angles ending in their unit."""
    r, (factor, unit) = tuning.constraints, channel_display_unit(tuning.actuator)
    ending = "" if unit == "1" else f"_{unit}".replace("/", "_per_")
    return _finite_numbers({
        "Ms": r.Ms,
        "saturation": r.saturation,
        "rate_saturation": r.rate_saturation,
        f"limit{ending}": r.limit * factor,
        f"rate{ending}_per_s": r.rate * factor,
        f"stall{ending}": r.stall * factor,
    })  # fmt: skip


def _schedule_entry(point: OperatingPoint) -> dict[str, Any]:
    return {
        "U": float(point.U),
        "heading_deg": math.degrees(point.beta),
        "height": float(point.height),
        "gains": _finite_numbers(point.gains),
        **_finite_numbers({"cost": point.cost, "Ms": point.Ms, "saturation": point.saturation}),
        "feasible": bool(point.is_feasible),
    }


def _number_text(value: float) -> str:
    return f"{value:.8g}" if math.isfinite(value) else ""


def _csv_cell(text: str) -> str:
    return '"' + text.replace('"', '""') + '"' if re.search(r'[",\n]', text) else text
