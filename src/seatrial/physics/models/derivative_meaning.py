"""What a hydrodynamic coefficient stands for, from its name: ``Y_vvr`` multiplies v^2 r in the sway force."""

from itertools import groupby

_FORCES = {"X": "surge force", "Y": "sway force", "N": "yaw moment", "R": "resistance"}
_VARIABLES = {"d": "delta"}


def derivative_meaning(name: str, term: str = "") -> str:
    """Return force or moment and what the coefficient multiplies there: ``sway force from v^2 r``.

    term: what it multiplies, where that is not the product of the letters behind the underscore, such as ``v|v|``.
    """
    force, _, letters = name.partition("_")
    powers = ((_VARIABLES.get(letter, letter), len(list(same))) for letter, same in groupby(letters.replace("0", "")))
    product = term or " ".join(f"{letter}^{power}" if power > 1 else letter for letter, power in powers)
    return f"{_FORCES[force]} from {product}" if product else f"{_FORCES[force]} straight ahead"
