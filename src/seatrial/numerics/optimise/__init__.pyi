"""Names of this package, imported when first used."""

from seatrial.numerics.optimise.population import Box as Box, Optimiser as Optimiser, SearchError as SearchError
from seatrial.numerics.optimise.population import fitness_function as fitness_function, search as search
from seatrial.numerics.optimise.particle_swarm import CloudParticleSwarm as CloudParticleSwarm
from seatrial.numerics.optimise.particle_swarm import CloudSettings as CloudSettings
from seatrial.numerics.optimise.cma_es import AdaptationSettings as AdaptationSettings
from seatrial.numerics.optimise.cma_es import CovarianceAdaptation as CovarianceAdaptation
from seatrial.numerics.optimise.differential_evolution import DifferentialEvolution as DifferentialEvolution
from seatrial.numerics.optimise.differential_evolution import EvolutionSettings as EvolutionSettings
from seatrial.numerics.optimise.population import hypervolume as hypervolume, non_dominated as non_dominated
from seatrial.numerics.optimise.wild_horse import ImprovedHerdSettings as ImprovedHerdSettings
from seatrial.numerics.optimise.wild_horse import ImprovedWildHorse as ImprovedWildHorse
from seatrial.numerics.optimise.least_squares import LeastSquaresProblem as LeastSquaresProblem
from seatrial.numerics.optimise.least_squares import NormalEquations as NormalEquations, Optimum as Optimum
from seatrial.numerics.optimise.least_squares import bounded_step as bounded_step
from seatrial.numerics.optimise.least_squares import levenberg_marquardt as levenberg_marquardt
from seatrial.numerics.optimise.least_squares import predicted_decrease as predicted_decrease
from seatrial.numerics.optimise.multistart import Multistart as Multistart, RestartSettings as RestartSettings
from seatrial.numerics.optimise.multistart import multistart as multistart
from seatrial.numerics.optimise.named import OPTIMISERS as OPTIMISERS, OptimiserFactory as OptimiserFactory
from seatrial.numerics.optimise.named import SEARCH_METHODS as SEARCH_METHODS, SearchBudget as SearchBudget
from seatrial.numerics.optimise.named import SearchMethod as SearchMethod, optimiser_named as optimiser_named
from seatrial.numerics.optimise.particle_swarm import ParticleSwarm as ParticleSwarm, SwarmSettings as SwarmSettings
from seatrial.numerics.optimise.population import FitnessMemory as FitnessMemory, Population as Population
from seatrial.numerics.optimise.random_weight_genetic import GeneticSettings as GeneticSettings
from seatrial.numerics.optimise.random_weight_genetic import NonDominatedSet as NonDominatedSet
from seatrial.numerics.optimise.random_weight_genetic import Normaliser as Normaliser
from seatrial.numerics.optimise.random_weight_genetic import RandomWeightGenetic as RandomWeightGenetic
from seatrial.numerics.optimise.random_weight_genetic import decode as decode, encode as encode
from seatrial.numerics.optimise.random_weight_genetic import selection_probabilities as selection_probabilities
from seatrial.numerics.optimise.least_squares import Solution as Solution, Status as Status
from seatrial.numerics.optimise.wild_horse import HerdSettings as HerdSettings, StrideVariant as StrideVariant
from seatrial.numerics.optimise.wild_horse import WildHorse as WildHorse
