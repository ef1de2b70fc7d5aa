"""Names of this package, imported when first used."""

from seatrial.onboard.stream_session import SampleOrder as SampleOrder
from seatrial.onboard.sources import open_source as open_source
