"""Names of this package, imported when first used."""

from seatrial.estimation.search.fitness import (
    Fitness as Fitness,
    one_sample_fitness as one_sample_fitness,
    whole_record_fitness as whole_record_fitness,
)
from seatrial.estimation.search.linear_candidates import (
    JudgedRun as JudgedRun,
    LinearCandidates as LinearCandidates,
)
from seatrial.estimation.search.methods import (
    SearchBudget as SearchBudget,
    SearchMethod as SearchMethod,
    search_method as search_method,
)
from seatrial.estimation.search.restarts import (
    FinishedSearch as FinishedSearch,
    run_search as run_search,
)
