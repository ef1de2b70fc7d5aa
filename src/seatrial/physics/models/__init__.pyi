from seatrial.physics.models.candidate_terms import with_candidate_terms
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.catalogue import ModelSummary, model_summaries
from seatrial.physics.models.heave_pitch import heave_pitch, heave_pitch_strip, heave_pitch_zoh
from seatrial.physics.models.heave_pitch_coefficients import (
    HEAVE_PITCH_COEFFICIENTS,
    HEAVE_PITCH_STIFFNESSES,
    physical_start_values,
)
from seatrial.physics.models.mmg import mmg
from seatrial.physics.models.nomoto import nomoto, nomoto2
from seatrial.physics.models.parameter_set import ParameterSet
from seatrial.physics.models.published import PARAMETER_SETS, parameter_set
from seatrial.physics.models.registry import MODELS, model_from_file, model_named
from seatrial.physics.models.roll import roll
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS, waterjet

__all__ = [
    "HEAVE_PITCH_COEFFICIENTS",
    "HEAVE_PITCH_STIFFNESSES",
    "MODELS",
    "PARAMETER_SETS",
    "WATERJET_COEFFICIENTS",
    "ModelSummary",
    "ParameterSet",
    "abkowitz",
    "heave_pitch",
    "heave_pitch_strip",
    "heave_pitch_zoh",
    "mmg",
    "model_from_file",
    "model_named",
    "model_summaries",
    "nomoto",
    "nomoto2",
    "parameter_set",
    "physical_start_values",
    "roll",
    "waterjet",
    "with_candidate_terms",
]
