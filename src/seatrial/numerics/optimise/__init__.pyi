"""Names of this package, imported when first used."""

from seatrial.numerics.optimise.ask_tell import (
    Box as Box,
    Optimiser as Optimiser,
    SearchError as SearchError,
    fitness_function as fitness_function,
    search as search,
)
from seatrial.numerics.optimise.cloud_particle_swarm import (
    CloudParticleSwarm as CloudParticleSwarm,
    CloudSettings as CloudSettings,
)
from seatrial.numerics.optimise.cma_es import (
    AdaptationSettings as AdaptationSettings,
    CovarianceAdaptation as CovarianceAdaptation,
)
from seatrial.numerics.optimise.differential_evolution import (
    DifferentialEvolution as DifferentialEvolution,
    EvolutionSettings as EvolutionSettings,
)
from seatrial.numerics.optimise.dominance import (
    hypervolume as hypervolume,
    non_dominated as non_dominated,
)
from seatrial.numerics.optimise.improved_wild_horse import (
    ImprovedHerdSettings as ImprovedHerdSettings,
    ImprovedWildHorse as ImprovedWildHorse,
)
from seatrial.numerics.optimise.least_squares import (
    LeastSquaresProblem as LeastSquaresProblem,
    NormalEquations as NormalEquations,
    Optimum as Optimum,
    levenberg_marquardt as levenberg_marquardt,
)
from seatrial.numerics.optimise.multistart import (
    Multistart as Multistart,
    RestartSettings as RestartSettings,
    multistart as multistart,
)
from seatrial.numerics.optimise.named import (
    OPTIMISERS as OPTIMISERS,
    OptimiserFactory as OptimiserFactory,
    optimiser_named as optimiser_named,
)
from seatrial.numerics.optimise.particle_swarm import (
    ParticleSwarm as ParticleSwarm,
    SwarmSettings as SwarmSettings,
)
from seatrial.numerics.optimise.population import (
    FitnessMemory as FitnessMemory,
    Population as Population,
)
from seatrial.numerics.optimise.random_weight_genetic import (
    GeneticSettings as GeneticSettings,
    NonDominatedSet as NonDominatedSet,
    Normaliser as Normaliser,
    RandomWeightGenetic as RandomWeightGenetic,
    decode as decode,
    encode as encode,
    selection_probabilities as selection_probabilities,
)
from seatrial.numerics.optimise.solution import (
    Solution as Solution,
    Status as Status,
)
from seatrial.numerics.optimise.wild_horse import (
    HerdSettings as HerdSettings,
    StrideVariant as StrideVariant,
    WildHorse as WildHorse,
)
