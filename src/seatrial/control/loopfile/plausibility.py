"""Loop files whose numbers are valid but cannot be meant: motions no ship makes, actuators that push the wrong way."""

import math
from collections.abc import Sequence

import numpy as np

from seatrial.control.loopfile.plant import LoopPlant
from seatrial.control.loopfile.quantities import symbol_unit
from seatrial.control.task import Seaway, SlowDisturbance
from seatrial.core.values import InputError
from seatrial.physics.loops import Block, TransferLoop

_WILDEST_RMS = math.radians(30.0)  # rad: the highest third of such amplitudes is 60 degrees and more; chosen
# actuator -> output and what a positive one does to it by the conventions of the notation
_POSITIVE_EFFECTS = {
    ("delta", "psi"): "turns the ship to starboard",
    ("alpha_f", "phi"): "rolls the ship to starboard",
}


def refuse_reversed_plant(plant: LoopPlant, where: str) -> None:
    """Refuse a plant whose actuator first moves the output against the convention of its sign.

    The first motion after a step has the sign of the leading coefficients, also where the plant is unstable.
    """
    effect = _POSITIVE_EFFECTS.get((plant.actuator, plant.output))
    first = plant.response.num[0] / plant.response.den[0]
    if effect is None or first > 0.0:
        return
    remedy = (
        f"reverse the signs of {where}.num"
        if plant.trimmed_ship is None
        else f"give {plant.actuator} its sign in [records.channels] of the trial (positive = ...) and identify again"
    )
    raise InputError(
        f"{where}: a positive {plant.actuator} {effect} by convention, here it first does the opposite; {remedy}"
    )


def refuse_reversed_servo(servo: Sequence[Block]) -> None:
    """Refuse a servo that moves the actuator against its order."""
    for i, block in enumerate(servo, start=1):
        if block.gain < 0.0:
            raise InputError(
                f"actuator.servo[{i}] answers an order of 1 with {block.gain:.3g}: the actuator would move against its "
                "order; reverse the signs of its num"
            )


def refuse_wild_motion(disturbances: Sequence[Seaway | SlowDisturbance], loop: TransferLoop, plant: LoopPlant) -> None:
    """Refuse what would move an angle further without control than linear theory, or a ship, allows."""
    if symbol_unit(plant.output) != "rad" or not math.isfinite(loop.disturbance.gain):
        return
    for one in disturbances:
        rms = math.sqrt(one.exposure(loop).response_variance(one.disturbed(loop).disturbance))
        if rms > _WILDEST_RMS:
            raise InputError(
                f"without control {plant.output} would reach {math.degrees(rms):.3g} deg rms ({one.description}), more "
                f"than any ship survives; check height and period of the sea, and the plant: damping ratio "
                f"{_least_damping(loop.disturbance):.2g}, {loop.disturbance.gain:.3g} of the output for a constant 1 "
                "of the disturbance"
            )


def _least_damping(block: Block) -> float:
    poles = block.poles
    return float(np.min(-poles.real / np.abs(poles), initial=1.0))
