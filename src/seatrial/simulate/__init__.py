"""The only way from a model and a record to arrays and back: replayed inputs, or a programme steered.

`manoeuvre` is in `seatrial.simulate.steer`, apart because its helmsmen are compiled when they are imported.
"""

from seatrial.simulate.channels import inputs_of, record_of
from seatrial.simulate.forces import forces
from seatrial.simulate.replay import replay

__all__ = ["forces", "inputs_of", "record_of", "replay"]
