"""The contract every optimiser keeps: points in the box, order of ask and tell, refusals, same seed same bits."""

from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.numerics.optimise.landscapes import BOX, KINDS, SQUARE, WITH_MEMORY, Array, make_optimiser

from seatrial.numerics.optimise import (
    AdaptationSettings,
    Box,
    CloudSettings,
    EvolutionSettings,
    FitnessMemory,
    HerdSettings,
    ImprovedHerdSettings,
    SearchError,
    Status,
    SwarmSettings,
    search,
)

EVERY = pytest.mark.parametrize("kind", KINDS)


@EVERY
def test_asked_again_it_gives_the_same_points_whatever_was_done_to_them(kind: str) -> None:
    optimiser = make_optimiser(kind, BOX, 1)
    for _ in range(3):
        points = optimiser.ask()
        kept = points.copy()
        assert points.shape[1] == BOX.size
        points[:] = 0.0
        assert np.array_equal(optimiser.ask(), kept)
        optimiser.tell(SQUARE(kept))
        assert SQUARE(optimiser.best[0][None])[0] == pytest.approx(optimiser.best[1], rel=1e-13)


@EVERY
def test_same_seed_same_bits_another_seed_others(kind: str) -> None:
    first, again, other = (search(make_optimiser(kind, BOX, seed, iterations=30), SQUARE) for seed in (5, 5, 6))
    assert first.point.tobytes() == again.point.tobytes()
    assert first.history == again.history
    assert first.history != other.history
    assert first.seed == 5


@EVERY
def test_a_callers_array_may_be_used_again(kind: str) -> None:
    """Kernels write every population's fitness into one array."""
    kept, reused = make_optimiser(kind, BOX, 5, iterations=20), make_optimiser(kind, BOX, 5, iterations=20)
    buffer = np.empty(40)
    while not kept.done:
        kept.tell(SQUARE(kept.ask()))
        buffer[:] = SQUARE(reused.ask())
        reused.tell(buffer)
        buffer[:] = np.nan
    assert kept.trace.tobytes() == reused.trace.tobytes()
    assert kept.history == reused.history


@EVERY
def test_the_record_tells_the_best_so_far(kind: str) -> None:
    optimiser = make_optimiser(kind, BOX, 2, iterations=25)
    seen: list[float] = []
    assert optimiser.best[1] == np.inf
    while not optimiser.done:
        costs = SQUARE(optimiser.ask())
        optimiser.tell(costs)
        seen.append(min([*seen[-1:], float(costs.min())]))
    assert optimiser.history == tuple(seen)
    assert len(seen) == 25
    assert np.allclose(SQUARE(optimiser.trace), seen, rtol=1e-13)
    assert np.array_equal(optimiser.trace[-1], optimiser.best[0])


@EVERY
def test_a_search_counts_what_it_evaluates_and_reports_its_progress(kind: str) -> None:
    rows: list[int] = []
    heard: list[tuple[int, float]] = []

    def fitness(points: Array) -> Array:
        rows.append(len(points))
        return SQUARE(points)

    solution = search(
        make_optimiser(kind, BOX, 3, iterations=10), fitness, lambda count, value: heard.append((count, value))
    )
    assert solution.evaluations == sum(rows) == heard[-1][0] == 400
    assert solution.value == heard[-1][1]
    assert solution.status is Status.EXHAUSTED


@EVERY
@given(seed=st.integers(0, 2**32), centre=st.floats(-1e6, 1e6), width=st.floats(1e-3, 1e6), size=st.integers(2, 5))
@settings(max_examples=15, deadline=None)
def test_the_box_is_never_left(kind: str, seed: int, centre: float, width: float, size: int) -> None:
    box = Box(np.full(size, centre), np.full(size, centre) + width * np.arange(1, size + 1))
    optimiser = make_optimiser(kind, box, seed, population=14, iterations=8)
    noise = np.random.default_rng(seed)
    while not optimiser.done:
        points = optimiser.ask()
        assert np.all((points >= box.lower) & (points <= box.upper))
        optimiser.tell(noise.exponential(size=len(points)))


@EVERY
def test_points_that_cannot_be_evaluated_are_avoided(kind: str) -> None:
    def fitness(points: Array) -> Array:
        return np.where(points[:, 0] > 2.5, np.inf, SQUARE(points))

    assert search(make_optimiser(kind, BOX, 4), fitness).value < 0.05


@EVERY
def test_where_nothing_can_be_evaluated_the_search_failed(kind: str) -> None:
    solution = search(make_optimiser(kind, BOX, 4, iterations=6), lambda points: np.full(len(points), np.inf))
    assert solution.status is Status.FAILED


@EVERY
@pytest.mark.parametrize("value", [np.nan, -np.inf])
def test_a_fitness_without_order_names_its_row(kind: str, value: float) -> None:
    optimiser = make_optimiser(kind, BOX, 1)
    optimiser.tell(SQUARE(optimiser.ask()))
    costs = SQUARE(optimiser.ask())
    costs[7] = value
    with pytest.raises(SearchError, match=r"row 7 in iteration 1 is -?(nan|inf) at \["):
        optimiser.tell(costs)


@EVERY
def test_telling_out_of_turn_or_another_shape_is_refused(kind: str) -> None:
    optimiser = make_optimiser(kind, BOX, 1)
    with pytest.raises(SearchError, match=r"before ask\(\) was called"):
        optimiser.tell(np.zeros(40))
    optimiser.ask()
    with pytest.raises(SearchError, match=r"40 points has shape \(39,\)"):
        optimiser.tell(np.zeros(39))


@EVERY
@pytest.mark.parametrize(("population", "iterations", "says"), [(1, 5, "needs"), (40, 0, "at least 1 iteration")])
def test_too_small_a_search_is_refused(kind: str, population: int, iterations: int, says: str) -> None:
    with pytest.raises(SearchError, match=says):
        make_optimiser(kind, BOX, 1, population, iterations)


@pytest.mark.parametrize(
    ("settings_made", "says"),
    [
        (lambda: SwarmSettings(omega=np.nan), "Setting omega is nan"),
        (lambda: SwarmSettings(c2=np.inf), "Setting c2 is inf"),
        (lambda: HerdSettings(P_S=np.nan), "Setting P_S is nan"),
        (lambda: ImprovedHerdSettings(omega_max=np.inf), "Setting omega_max is inf"),
        (lambda: CloudSettings(w1=np.nan), "Setting w1 is nan"),
        (lambda: CloudSettings(spread=-0.1), "Setting spread is the width of a normal law, not -0.1"),
        (lambda: EvolutionSettings(F=np.nan), "Setting F is nan"),
        (lambda: AdaptationSettings(step=np.inf), "Setting step is inf"),
    ],
)
def test_settings_without_a_value_are_refused(settings_made: Callable[[], object], says: str) -> None:
    with pytest.raises(SearchError, match=says):
        settings_made()


@pytest.mark.parametrize("kind", WITH_MEMORY)
@pytest.mark.parametrize("memory", FitnessMemory)
def test_under_a_changing_fitness_only_re_evaluated_memories_are_comparable(kind: str, memory: FitnessMemory) -> None:
    """The fitness of iteration k has an offset of its own: what was remembered from another iteration is stale."""
    offsets = 10 + np.random.default_rng(9).exponential(50.0, 40)
    optimiser = KINDS[kind](BOX, np.random.default_rng(1), 40, 40, memory)
    for offset in offsets:
        optimiser.tell(SQUARE(optimiser.ask()) + offset)
    now = SQUARE(optimiser.trace) + offsets
    fresh = np.allclose(optimiser.history, now, rtol=1e-13)
    assert fresh is (memory is FitnessMemory.RE_EVALUATE)
    if memory is FitnessMemory.RE_EVALUATE:
        assert SQUARE(optimiser.trace)[-1] < 0.1 * SQUARE(optimiser.trace)[0]


@pytest.mark.parametrize(
    ("lower", "upper", "says"),
    [
        ([0.0, 2.0], [1.0, 2.0], "Bound 1 runs from 2.0 to 2.0"),
        ([0.0, np.nan], [1.0, 2.0], "Bound 1 runs from nan"),
        ([0.0, 0.0], [1.0, np.inf], "finite"),
        ([-1e308], [1e308], "finite"),
        ([0.0], [1.0, 2.0], "one shape"),
        ([], [], "one shape"),
    ],
)
def test_bounds_out_of_order_are_refused(lower: list[float], upper: list[float], says: str) -> None:
    with pytest.raises(SearchError, match=says):
        Box(np.array(lower), np.array(upper))
