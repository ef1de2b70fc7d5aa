"""The breakdown of forces along a record."""

from seatrial.core.equations import Model
from seatrial.core.values import Array, InputError, Record
from seatrial.physics.simulate.channels import inputs_of


def forces(model: Model, record: Record) -> dict[str, Array]:
    """Every binding of the model (forces, speeds, angles; SI units) at the record's samples: name -> (n,).

    Raises:
        InputError: the record lacks a state or an input of the model.
    """
    absent = [s for s in model.states if s not in record]
    if absent:
        raise InputError(
            f"record '{record.name}' has no channel '{absent[0]}', a state of model '{model.name}'; simulate it first"
        )
    return model.forces(record.matrix(model.states), inputs_of(model, record))
