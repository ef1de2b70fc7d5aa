"""An identified model at another scale, by Froude's law: that of a ship from the trials of its model."""

from dataclasses import replace

import numpy as np

from seatrial.core.values import NOTATION, InputError, Parameter, Parameters, frozen
from seatrial.core.values.record import froude_factor
from seatrial.data.folder.model_file import ModelFile

_LENGTHS = ("L", "B", "d")


def model_at_scale(file: ModelFile, ratio: float) -> ModelFile:
    """Return a model file of a craft `ratio` times as large: every parameter, its covariance, ship and approach.

    Coefficients without dimension stay; the density of the water does, too. Of the ship's particulars those that the
    model knows and its length, breadth and draught are kept.

    Raises:
        InputError: the ratio is not positive, or a parameter has a unit of which no exponent is known.
    """
    factors = {p.name: _factor(p, ratio) for p in file.model.parameters}
    scaled = Parameters(tuple(_scaled(p, factors[p.name]) for p in file.model.parameters))
    size = np.array([factors[name] for name in scaled.free_names])
    factors |= dict.fromkeys(_LENGTHS, froude_factor("m", ratio))
    ship = file.ship
    if ship is not None:
        particulars = {name: value * factors[name] for name, value in ship.particulars.items() if name in factors}
        ship = replace(ship, name=f"{ship.name}, times {ratio:g}", particulars=particulars, scale=ship.scale / ratio)
    return replace(
        file,
        model=file.model.with_parameters(scaled),
        covariance=frozen(file.covariance * np.outer(size, size)) if file.covariance.size else file.covariance,
        ship=ship,
        approach={name: value * froude_factor(NOTATION[name].unit, ratio) for name, value in file.approach.items()},
        interval_basis=None,
    )


def _factor(parameter: Parameter, ratio: float) -> float:
    try:
        return froude_factor(parameter.unit, ratio)
    except InputError as error:
        raise InputError(f"parameter {parameter.name}: {error}") from None


def _scaled(p: Parameter, factor: float) -> Parameter:
    """Return the parameter times a factor; what was known before the fit has gone into its value."""
    return replace(
        p, value=p.value * factor, lower=p.lower * factor, upper=p.upper * factor, scale=p.scale * factor, prior=None
    )
