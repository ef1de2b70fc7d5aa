"""Draws from a density by Markov chains, begun from the Gaussian that resembles it; how far they can be trusted.

Proposals keep that Gaussian (preconditioned Crank-Nicolson; Cotter, Roberts, Stuart & White 2013, Stat. Sci. 28, 424,
section 4), so that only where the density departs from it are proposals refused, whatever the number of unknowns. The
chains are those of emcee (Foreman-Mackey, Hogg, Lang & Goodman 2013, PASP 125, 306).
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from emcee import EnsembleSampler

Array = npt.NDArray[np.float64]

_STEP_SIZES = np.array([0.2, 0.6, 1.0, 1.0])
"""Sizes of a proposal, one at random each time: 1 is a draw of its own, smaller ones follow bends; chosen."""

_MOST_HALVINGS = 40
"""Halvings of a start's distance from the centre, at most; chosen: the distance is then rounding."""


@dataclass(frozen=True)
class ChainSettings:
    """How many chains of what length.

    Attributes:
        chains: chains, each from a draw of its own.
        block: steps between two looks at them; the first block is left out.
        effective_size: independent draws of each unknown at which they end; r_hat: and this factor at most (both by
            Vehtari, Gelman, Simpson, Carpenter & Bürkner 2021, Bayesian Analysis 16, 667, section 4).
        most_steps: steps at which they end in any case.
    """

    chains: int = 4
    block: int = 50
    effective_size: float = 400.0
    r_hat: float = 1.01
    most_steps: int = 2000


@dataclass(frozen=True, eq=False)
class Chains:
    """Draws of chains and how far they agree.

    Attributes:
        points: (chains, draws, n); log_density: (chains, draws), up to a constant.
        acceptance: share of the proposals that were taken.
        r_hat: split R-hat of each unknown, (n,): 1 where the chains agree; effective_size: independent draws, (n,).
        is_converged: whether both are as required; is_interrupted: whether a user ended them.
    """

    points: Array
    log_density: Array
    acceptance: float
    r_hat: Array
    effective_size: Array
    is_converged: bool
    is_interrupted: bool = False


def sample_chains(
    log_density: Callable[[Array], Array],
    centre: Array,
    covariance: Array,
    seed: int,
    settings: ChainSettings | None = None,
    report_progress: Callable[[str], None] = lambda _: None,
) -> Chains:
    """Draw from a density until the chains agree; the same seed gives the same bits.

    Args:
        log_density: points (m, n) -> its logarithms (m,), minus infinity where it is zero.
        centre, covariance: of the Gaussian that resembles it, (n,) and (n, n).

    Raises:
        ImportError: emcee is not installed.
        KeyboardInterrupt: a user ended the chains in their first two blocks, where they are worth nothing.
    """
    settings = settings or ChainSettings()
    root = _root(covariance)
    sampler = _sampler(log_density, centre, root, settings.chains)
    random = np.random.RandomState(seed)  # the kind that emcee takes
    state = _possible_starts(log_density, centre, random.standard_normal((settings.chains, len(centre))) @ root.T)
    state, steps, chains = np.linalg.solve(root, state.T).T, 0, None
    sampler.random_state = random.get_state()
    while steps < settings.most_steps:
        try:
            state = sampler.run_mcmc(state, settings.block, skip_initial_state_check=True)
        except KeyboardInterrupt:
            if chains is None:
                raise
            return Chains(**{**vars(chains), "is_interrupted": True})
        steps += settings.block
        if steps > settings.block:
            chains = _examined(sampler, centre, root, settings)
            report_progress(
                f"sampling: {settings.chains} chains of {steps} draws, R-hat {np.max(chains.r_hat):.3f}, at least "
                f"{np.min(chains.effective_size):.0f} independent draws"
            )
            if chains.is_converged:
                break
    assert chains is not None
    return chains


def _possible_starts(log_density: Callable[[Array], Array], centre: Array, away: Array) -> Array:
    """Distances from the centre, (chains, n), each halved to the other side until the density is positive."""
    for _ in range(_MOST_HALVINGS):
        impossible = ~np.isfinite(log_density(centre + away))
        if not impossible.any():
            break
        away[impossible] *= -0.5
    return away


def _sampler(log_density: Callable[[Array], Array], centre: Array, root: Array, count: int) -> "EnsembleSampler":
    """The chains in coordinates in which the Gaussian has no correlation and unit variances."""
    from emcee import EnsembleSampler
    from emcee.moves import MHMove

    def proposal(current: Array, random: np.random.RandomState) -> tuple[Array, Array]:
        """Cotter et al. 2013, eq. (4.5): sqrt(1 - b^2) z + b w; the Gaussian's ratio for the acceptance."""
        share = _STEP_SIZES[random.randint(len(_STEP_SIZES), size=len(current))][:, None]
        to = np.sqrt(1.0 - share**2) * current + share * random.standard_normal(current.shape)
        return to, 0.5 * (np.sum(to**2, axis=1) - np.sum(current**2, axis=1))

    move = MHMove(proposal, ndim=len(centre))
    return EnsembleSampler(count, len(centre), lambda z: log_density(centre + z @ root.T), moves=move, vectorize=True)


def _root(covariance: Array) -> Array:
    scale = np.sqrt(np.diag(covariance))
    root = np.linalg.cholesky(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * root, dtype=np.float64)


def _examined(sampler: "EnsembleSampler", centre: Array, root: Array, settings: ChainSettings) -> Chains:
    first = settings.block
    whitened = np.swapaxes(np.asarray(sampler.get_chain(discard=first)), 0, 1)
    points = centre + whitened @ root.T
    factors, sizes = split_r_hat(points), effective_sizes(points)
    is_converged = bool(np.max(factors) <= settings.r_hat and np.min(sizes) >= settings.effective_size)
    log_density = np.ascontiguousarray(np.asarray(sampler.get_log_prob(discard=first)).T)
    return Chains(points, log_density, float(np.mean(sampler.acceptance_fraction)), factors, sizes, is_converged)


def split_r_hat(points: Array) -> Array:
    """Return the split R-hat of each unknown, (n,), of chains (chains, draws, n): 1 where halves of chains agree.

    Vehtari et al. 2021, eqs. (1)-(4); infinite where no chain moves.
    """
    half = points.shape[1] // 2
    halves = np.concatenate([points[:, :half], points[:, -half:]])
    within = np.mean(np.var(halves, axis=1, ddof=1), axis=0)
    between = half * np.var(np.mean(halves, axis=1), axis=0, ddof=1)
    variance = (half - 1) / half * within + between / half
    return np.sqrt(np.divide(variance, within, out=np.full_like(within, np.inf), where=within > 0.0))


def effective_sizes(points: Array) -> Array:
    """Return how many independent draws the draws (chains, draws, n) of each unknown are worth, (n,), at most all.

    Draws over the integrated autocorrelation time (Sokal 1997; emcee's estimate, averaged over the chains).
    """
    from emcee.autocorr import integrated_time

    time = np.asarray(integrated_time(np.swapaxes(points, 0, 1), quiet=True, tol=0))
    total = points.shape[0] * points.shape[1]
    return total / np.maximum(np.where(np.isfinite(time), time, np.inf), 1.0)
