"""Names of this package, imported when first used."""

from seatrial.physics.sea.spectrum import speed_factor as speed_factor, wave_frequency as wave_frequency
from seatrial.physics.sea.realise import DEFAULT_COMPONENTS as DEFAULT_COMPONENTS, Spacing as Spacing
from seatrial.physics.sea.realise import WaveComponents as WaveComponents, harmonic_sum as harmonic_sum
from seatrial.physics.sea.realise import realise as realise, short_crested as short_crested, wave_record as wave_record
from seatrial.physics.sea.wave_forces import MotionStatistics as MotionStatistics, motion_sickness as motion_sickness
from seatrial.physics.sea.wave_forces import (
    motion_statistics as motion_statistics,
    response_spectrum as response_spectrum,
)
from seatrial.physics.sea.wave_forces import vertical_motion as vertical_motion
from seatrial.physics.sea.spectrum import SeaState as SeaState, sea_state as sea_state
from seatrial.physics.sea.spectrum import Spectrum as Spectrum, bretschneider as bretschneider, ittc as ittc
from seatrial.physics.sea.spectrum import ittc_two_parameter as ittc_two_parameter, jonswap as jonswap
