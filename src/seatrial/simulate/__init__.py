"""The only way from a model and a record to arrays and back: replayed inputs, or a programme steered."""

from seatrial.simulate.channels import inputs_of, record_of
from seatrial.simulate.forces import forces
from seatrial.simulate.replay import replay
from seatrial.simulate.steer import manoeuvre

__all__ = ["forces", "inputs_of", "manoeuvre", "record_of", "replay"]
