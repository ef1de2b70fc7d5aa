"""Names of this package, imported when first used."""

from seatrial.estimation.problem.spectral_likelihood import FreeParameterProblem as FreeParameterProblem
from seatrial.estimation.problem.linear_output_error import LinearOutputError as LinearOutputError
from seatrial.estimation.problem.output_error import Nuisance as Nuisance, OutputError as OutputError
from seatrial.estimation.problem.prediction_error import PredictionError as PredictionError
from seatrial.estimation.problem.segments import Segments as Segments, compared_outputs as compared_outputs
from seatrial.estimation.problem.segments import cut_segments as cut_segments
from seatrial.estimation.problem.spectral_likelihood import SpectralLikelihood as SpectralLikelihood
from seatrial.estimation.problem.static_forces import StaticForces as StaticForces
from seatrial.estimation.problem.spectral_likelihood import UnknownWaves as UnknownWaves
