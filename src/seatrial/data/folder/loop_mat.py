"""The chosen loop of a tuning as a MAT-file: every block, the controller and the open loop as polynomials."""

import keyword
import re
from functools import reduce
from io import BytesIO
from typing import Any

import numpy as np
from numpy.typing import NDArray

from seatrial.core.results.tuning import Component, Tuning
from seatrial.core.values import InputError

HEADER = b"MATLAB 5.0 MAT-file, a feedback loop written by seatrial".ljust(116)
"""Text at the start of a MAT-file, 116 bytes by its format; it names no date, so that the same loop gives the same
bytes."""
RESERVED = {"end", "function", "otherwise", "switch", "case", "parfor", "spmd", "persistent", "catch", *keyword.kwlist}
"""Words that MATLAB or Python do not take for a variable."""
LONGEST_NAME = 60
"""Characters of a variable's name; MATLAB takes 63, a number may follow."""
POLYNOMIALS = ("controller_num", "controller_den", "open_loop_num", "open_loop_den")
Rational = tuple[NDArray[Any], NDArray[Any]]


def loop_mat(tuning: Tuning) -> bytes:
    """Return the chosen loop as a MAT-file of version 5; the same tuning gives the same bytes.

    A struct for each block (``num``, ``den``, ``role``, ``name``, ``gain``, ``value``), ``gains``, and where there are
    terms ``controller_num``, ``controller_den`` (K, from the output to the actuator, which moves by minus K y) and
    ``open_loop_num``, ``open_loop_den`` (L = P K). Powers of s fall, angles are radians.
    """
    from scipy.io import savemat

    gains = tuning.chosen.gains
    content: dict[str, Any] = {"gains": {_matlab_name(name): value for name, value in gains.items()}}
    for name, component in _matlab_names(tuning.components, {*content, *POLYNOMIALS}).items():
        content[name] = {
            "num": np.array(component.num), "den": np.array(component.den), "role": component.role,
            "name": component.name, "gain": component.gain,
            "value": gains.get(component.gain, 1.0) if component.gain else 1.0,
        }  # fmt: skip
    if any(c.role == "term" for c in tuning.components):
        controller, loop = controller_polynomials(tuning), open_loop_polynomials(tuning)
        content |= dict(zip(POLYNOMIALS, (*controller, *loop), strict=True))
    buffer = BytesIO()
    savemat(buffer, content, format="5", long_field_names=True, oned_as="row")  # type: ignore[arg-type]
    return HEADER + buffer.getvalue()[len(HEADER) :]


def controller_polynomials(tuning: Tuning) -> Rational:
    """Return K(s) = sensors * (sum of gain_i term_i) * filters * servo as num and den, highest power first.

    Raises:
        InputError: a term's gain is not among the chosen ones.
    """
    terms = [c for c in tuning.components if c.role == "term"]
    dens = list(dict.fromkeys(c.den for c in terms))
    parallel = np.zeros(1)
    for term in terms:
        if term.gain not in tuning.chosen.gains:
            raise InputError(f"term '{term.name}' is multiplied by '{term.gain}', which is none of the chosen gains")
        other_dens = (den for den in dens if den != term.den)
        numerator = reduce(np.polymul, other_dens, tuning.chosen.gains[term.gain] * np.array(term.num))
        parallel = np.polyadd(parallel, np.atleast_1d(numerator))
    sum_of_terms = np.atleast_1d(parallel), reduce(np.polymul, dens, np.ones(1))
    return _product(sum_of_terms, tuple(c for c in tuning.components if c.role in ("sensor", "filter", "servo")))


def open_loop_polynomials(tuning: Tuning) -> Rational:
    """Return L(s) = P(s) K(s) as num and den; the loop is closed negatively."""
    return _product(controller_polynomials(tuning), tuple(c for c in tuning.components if c.role == "plant"))


def _product(first: Rational, components: tuple[Component, ...]) -> Rational:
    num, den = first
    for c in components:
        num, den = np.polymul(num, c.num), np.polymul(den, c.den)
    return num, den


def _matlab_names(components: tuple[Component, ...], reserved: set[str]) -> dict[str, Component]:
    """Return each block under a different name that MATLAB takes for a variable."""
    named: dict[str, Component] = {}
    for c in components:
        word = stem = _matlab_name(c.name if c.name.startswith(c.role) else f"{c.role}_{c.name}")
        count = 2
        while word in named or word in reserved:
            word, count = f"{stem}_{count}", count + 1
        named[word] = c
    return named


def _matlab_name(name: str) -> str:
    """Return a name of letters, digits and underscores, a letter first."""
    word = re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")[:LONGEST_NAME] or "unnamed"
    return f"x_{word}" if not word[0].isalpha() else f"{word}_" if word.lower() in RESERVED else word
