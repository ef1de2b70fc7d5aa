"""Names of this package, imported when first used."""

from seatrial.estimation.search.sample_search import (
    Candidates as Candidates,
    Fitness as Fitness,
    one_sample_fitness as one_sample_fitness,
    whole_record_fitness as whole_record_fitness,
)
from seatrial.estimation.search.candidates import LinearCandidates as LinearCandidates
from seatrial.estimation.search.sample_search import FinishedSearch as FinishedSearch, run_search as run_search
from seatrial.estimation.search.candidates import JudgedRun as JudgedRun
from seatrial.estimation.search.sample_search import SampleSearch as SampleSearch
from seatrial.estimation.search.candidates import SimulatedCandidates as SimulatedCandidates
