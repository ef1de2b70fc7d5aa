"""Names of this package, imported when first used."""

from seatrial.physics.models.abkowitz import abkowitz as abkowitz, abkowitz_roll as abkowitz_roll
from seatrial.physics.models.registry import ModelSummary as ModelSummary, model_summaries as model_summaries
from seatrial.physics.models.heave_pitch import heave_pitch as heave_pitch, heave_pitch_strip as heave_pitch_strip
from seatrial.physics.models.heave_pitch import heave_pitch_zoh as heave_pitch_zoh
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS as HEAVE_PITCH_COEFFICIENTS
from seatrial.physics.models.published import HEAVE_PITCH_STIFFNESSES as HEAVE_PITCH_STIFFNESSES
from seatrial.physics.models.published import physical_start_values as physical_start_values
from seatrial.physics.models.mmg import mmg as mmg, mmg_roll as mmg_roll
from seatrial.physics.models.mmg import mmg_shallow as mmg_shallow, mmg_twin as mmg_twin
from seatrial.physics.models.nomoto import nomoto as nomoto, nomoto2 as nomoto2
from seatrial.physics.models.published import ParameterSet as ParameterSet
from seatrial.physics.models.published import PARAMETER_SETS as PARAMETER_SETS, parameter_set as parameter_set
from seatrial.physics.models.registry import MODELS as MODELS, model_from_file as model_from_file
from seatrial.physics.models.registry import model_named as model_named
from seatrial.physics.models.roll import roll as roll
from seatrial.physics.models.section import section as section
from seatrial.physics.models.son_nomoto import son_nomoto as son_nomoto
from seatrial.physics.models.waterjet import WATERJET_COEFFICIENTS as WATERJET_COEFFICIENTS, waterjet as waterjet
from seatrial.physics.models.waterjet import waterjet_candidates as waterjet_candidates, waterjet_twin as waterjet_twin
from seatrial.physics.models.candidate_structures import with_candidate_terms as with_candidate_terms
from seatrial.physics.models.candidate_structures import with_terms as with_terms
