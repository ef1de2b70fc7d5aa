"""Names of this package, imported when first used."""

from seatrial.physics.simulate.batch import SegmentBatch as SegmentBatch, batch_class as batch_class
from seatrial.physics.simulate.replay import inputs_of as inputs_of, record_of as record_of
from seatrial.physics.simulate.replay import forces as forces
from seatrial.physics.simulate.craft_control import HeadingStep as HeadingStep
from seatrial.physics.simulate.linear import LinearSystem as LinearSystem, frequency_response as frequency_response
from seatrial.physics.simulate.linear import harmonic_motion as harmonic_motion, linear_system as linear_system
from seatrial.physics.simulate.linear import LinearBatch as LinearBatch
from seatrial.physics.simulate.population import Forcing as Forcing
from seatrial.physics.simulate.population import affine_population_matrices as affine_population_matrices
from seatrial.physics.simulate.population import discretised_hold as discretised_hold
from seatrial.physics.simulate.population import discretised_ramp as discretised_ramp, fitness as fitness
from seatrial.physics.simulate.population import one_sample_fitness as one_sample_fitness, trajectories as trajectories
from seatrial.physics.simulate.replay import ZERO_STARTS as ZERO_STARTS, initial_state as initial_state
from seatrial.physics.simulate.replay import replay as replay, trajectory as trajectory
from seatrial.physics.simulate.steer import SOLAS_SLEW_RATE as SOLAS_SLEW_RATE, manoeuvre as manoeuvre
from seatrial.physics.simulate.closed_loop import loop_record as loop_record
