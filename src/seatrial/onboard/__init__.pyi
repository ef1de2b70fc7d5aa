"""Names of this package, imported when first used."""

from seatrial.onboard.sample_order import SampleOrder as SampleOrder
from seatrial.onboard.sources import open_source as open_source
