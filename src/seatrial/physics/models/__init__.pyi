from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.catalogue import ModelSummary, model_summaries
from seatrial.physics.models.heave_pitch import heave_pitch, heave_pitch_strip, heave_pitch_zoh
from seatrial.physics.models.mmg import mmg
from seatrial.physics.models.nomoto import nomoto, nomoto2
from seatrial.physics.models.published import PARAMETER_SETS, parameter_set
from seatrial.physics.models.registry import MODELS, model_from_file, model_named
from seatrial.physics.models.roll import roll
from seatrial.physics.models.waterjet import waterjet

__all__ = [
    "MODELS",
    "PARAMETER_SETS",
    "ModelSummary",
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
    "roll",
    "waterjet",
]
