"""Names of this package, imported when first used."""

from seatrial.estimation.sea.wave_leg import EncounteredSea as EncounteredSea, encountered_sea as encountered_sea
from seatrial.estimation.sea.wave_leg import sea_spectrum as sea_spectrum
from seatrial.estimation.sea.wave_leg import LegFit as LegFit, LegPriors as LegPriors
from seatrial.estimation.sea.wave_leg import LegsInWaves as LegsInWaves, fit_legs as fit_legs
from seatrial.estimation.sea.wave_leg import PLANT_FACTORS as PLANT_FACTORS, altered_loop as altered_loop
from seatrial.estimation.sea.wave_leg import StretchSpectra as StretchSpectra
from seatrial.estimation.sea.wave_leg import stretch_spectra as stretch_spectra
from seatrial.estimation.sea.wave_leg import ObservedLeg as ObservedLeg
from seatrial.estimation.sea.wave_leg import WaveLeg as WaveLeg
from seatrial.estimation.sea.sea_likelihood import ShipInSea as ShipInSea, draw_ship_in_sea as draw_ship_in_sea
from seatrial.estimation.sea.sea_likelihood import TransformBins as TransformBins, band_edges as band_edges
from seatrial.estimation.sea.sea_likelihood import encounter_matrix as encounter_matrix
from seatrial.estimation.sea.sea_likelihood import BIN_STRIDE as BIN_STRIDE, HEADING_CELL as HEADING_CELL
from seatrial.estimation.sea.sea_likelihood import MotionSpectrum as MotionSpectrum, SeaLikelihood as SeaLikelihood
from seatrial.estimation.sea.section_waves import SectionFit as SectionFit, WaveResponses as WaveResponses
from seatrial.estimation.sea.section_waves import fit_section as fit_section, read_responses as read_responses
