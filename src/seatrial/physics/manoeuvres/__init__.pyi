"""Names of this package, imported when first used."""

from seatrial.physics.manoeuvres.imo import ImoCriterion as ImoCriterion, imo_criteria as imo_criteria
from seatrial.physics.manoeuvres.measures import measures as measures
from seatrial.physics.manoeuvres.programme import programme as programme
from seatrial.physics.manoeuvres.measures import bounded_interval as bounded_interval
from seatrial.physics.manoeuvres.recognition import (
    REACH_PERCENTILE as REACH_PERCENTILE,
    ManoeuvreKind as ManoeuvreKind,
    ObservedManoeuvre as ObservedManoeuvre,
    recognise_manoeuvre as recognise_manoeuvre,
    to_starboard as to_starboard,
)
from seatrial.physics.manoeuvres.recognition import (
    SteeredOrders as SteeredOrders,
    initial_speed as initial_speed,
    ordered_degrees as ordered_degrees,
    steered_orders as steered_orders,
)
