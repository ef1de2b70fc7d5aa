"""From a model and a record to a record: inputs replayed, manoeuvres steered, loops closed.

`manoeuvre` is in `seatrial.physics.simulate.steer`, apart because its helmsmen are compiled when they are imported.
"""

from seatrial.physics.simulate.channels import inputs_of, record_of
from seatrial.physics.simulate.forces import forces
from seatrial.physics.simulate.replay import replay

__all__ = ["forces", "inputs_of", "record_of", "replay"]
