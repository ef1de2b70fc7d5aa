"""Names of this package, imported when first used."""

from seatrial.estimation.information.covariance import (
    bootstrap as bootstrap,
    jackknife as jackknife,
    sandwich as sandwich,
)
from seatrial.estimation.information.covariance import (
    directions as directions,
    relative_information as relative_information,
)
from seatrial.estimation.information.discrepancy import (
    HoldoutError as HoldoutError,
    discrepancy as discrepancy,
)
from seatrial.estimation.information.extrapolation import extrapolation_index as extrapolation_index
from seatrial.estimation.information.symmetries import structural_symmetries as structural_symmetries
from seatrial.estimation.information.stability import stability as stability
