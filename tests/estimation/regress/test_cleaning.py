"""Cleaning: what goes is what the equation says, nothing is invented, order stays, and it is said."""

from collections.abc import Callable
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from seatrial.core.values import Array, Channel, InputError, Record, RecordKind
from seatrial.estimation.regress.samples import (
    first_occurrences,
    standard_scores,
    without_duplicates,
    without_missing,
    without_outliers,
    without_small,
)

NAN = float("nan")
BOTH = ("u", "v")
Step = Callable[[Record], Record]
STEPS: dict[str, Step] = {
    "duplicates": lambda record: without_duplicates(record, BOTH),
    "missing": lambda record: without_missing(record, BOTH),
    "small": lambda record: without_small(record, {"u": 1.0, "v": 0.5}),
}
OUTLIERS: Step = lambda record: without_outliers(record, 1.5, BOTH)  # noqa: E731
ALL = {**STEPS, "outliers": OUTLIERS}

# few distinct numbers, so that repetitions, small values and holes all come up
few = st.sampled_from([-2.0, -1.0, -0.5, -0.0, 0.0, 0.25, 0.5, 1.0, 1.5, 40.0, NAN])


@st.composite
def records(draw: st.DrawFn) -> Record:
    """An uneven record that keeps one good sample and no constant channel: every step leaves something."""
    rows = [*draw(st.lists(st.tuples(few, few), max_size=30)), (1.0, 1.0), (1.5, 0.5)]
    rows = draw(st.permutations(rows))
    gaps = draw(st.lists(st.sampled_from([0.1, 0.2, 3.0]), min_size=len(rows), max_size=len(rows)))
    u, v = np.array(rows).T
    number = np.arange(len(rows), dtype=float)
    return Record.from_arrays("drawn", np.cumsum(gaps), {"u": u, "v": v, "x0": number}, RecordKind.SIMULATED)


def of(u: list[float], v: list[float] | None = None) -> Record:
    """A record of 10 Hz."""
    values = {"u": np.array(u)} | ({"v": np.array(v)} if v is not None else {})
    return Record.from_arrays("run", 0.1 * np.arange(len(u)), values)


def kept(record: Record, cleaned: Record) -> Array:
    """Whether each sample of the record stayed, by its number in x0."""
    return np.isin(record["x0"], cleaned["x0"])


@pytest.mark.parametrize("name", ALL)
@given(record=records())
def test_nothing_is_invented_and_order_is_kept(name: str, record: Record) -> None:
    cleaned = ALL[name](record)
    rows = cleaned["x0"].astype(int)
    assert all(a < b for a, b in pairwise(rows.tolist()))
    np.testing.assert_array_equal(cleaned.time, record.time[rows])
    for symbol in record.channels:
        np.testing.assert_array_equal(cleaned[symbol], record[symbol][rows])
        assert cleaned.channel(symbol).metadata == record.channel(symbol).metadata
    assert (cleaned.kind, cleaned.name) == (record.kind, record.name)


@pytest.mark.parametrize("name", ALL)
@given(record=records())
def test_the_number_of_samples_that_went_is_stated(name: str, record: Record) -> None:
    cleaned = ALL[name](record)
    *before, step = cleaned.provenance.steps
    assert tuple(before) == record.provenance.steps
    assert step.startswith(f"{len(record) - len(cleaned)} of {len(record)} samples left out: ")


@pytest.mark.parametrize("name", STEPS)
@given(record=records())
def test_a_second_time_takes_nothing_more(name: str, record: Record) -> None:
    once = STEPS[name](record)
    np.testing.assert_array_equal(STEPS[name](once)["x0"], once["x0"])


def test_a_second_look_for_outliers_may_find_more() -> None:
    """Eq. (5) is one pass: without the largest value the next one stands out."""
    record = of([0.0, 0.1, -0.1, 0.05, -0.05, 0.1, -0.1, 0.0, 4.0, 100.0])
    once = without_outliers(record, 2.5, ["u"])
    assert len(once) == 9
    assert len(without_outliers(once, 2.5, ["u"])) == 8


@given(record=records())
def test_steps_that_look_at_samples_singly_may_be_taken_in_any_order(record: Record) -> None:
    one, other = STEPS["missing"], STEPS["small"]
    np.testing.assert_array_equal(one(other(record))["x0"], other(one(record))["x0"])


@given(record=records())
def test_what_stays_is_what_the_equations_say(record: Record) -> None:
    u, v = record["u"], record["v"]
    whole = np.array([a == a and b == b for a, b in zip(u, v, strict=True)])
    np.testing.assert_array_equal(kept(record, STEPS["missing"](record)), whole)
    small = np.array([abs(a) < 1.0 or abs(b) < 0.5 for a, b in zip(u, v, strict=True)])
    np.testing.assert_array_equal(kept(record, STEPS["small"](record)), ~small)
    seen: set[tuple[float, float]] = set()
    first = []
    for pair in zip(u.tolist(), v.tolist(), strict=True):
        first.append(any(x != x for x in pair) or pair not in seen)
        seen.add(pair)
    np.testing.assert_array_equal(kept(record, STEPS["duplicates"](record)), first)


@given(record=records())
def test_scores_have_mean_zero_and_deviation_one_and_decide_alone(record: Record) -> None:
    cleaned = kept(record, OUTLIERS(record))
    beyond = np.zeros(len(record), dtype=bool)
    for symbol in BOTH:
        scores = standard_scores(record[symbol])
        assert np.nanmean(scores) == pytest.approx(0.0, abs=1e-12)
        assert np.nanmean(scores**2) == pytest.approx(1.0)
        assert np.nanmax(np.abs(scores)) <= np.sqrt(len(record) - 1) * (1 + 1e-12)
        beyond |= np.abs(scores) > 1.5
    np.testing.assert_array_equal(cleaned, ~beyond)


@given(record=records(), scale=st.sampled_from([-4.0, 0.125, 1024.0]))
def test_outliers_do_not_depend_on_unit_or_sign(record: Record, scale: float) -> None:
    turned = record.with_channel("u", record.channel("u").with_values(scale * record["u"]))
    np.testing.assert_array_equal(OUTLIERS(turned)["x0"], OUTLIERS(record)["x0"])


def test_published_limits_on_normal_noise_take_what_the_normal_law_says(rng: np.random.Generator) -> None:
    """Beyond three deviations lies 0.270 % of a normal sample: 540 of 200 000, give or take 23."""
    record = Record.from_arrays("noise", 0.1 * np.arange(200_000), {"r": 0.3 + 0.01 * rng.standard_normal(200_000)})
    assert len(record) - len(without_outliers(record, 3.0, ["r"])) == pytest.approx(540, abs=4 * 23.2)


def test_repetitions_are_found_next_to_one_another_and_apart() -> None:
    record = of([1.0, 1.0, 2.0, 1.0, 2.0, 3.0], [0.0, 0.0, 5.0, -0.0, 6.0, 0.0])
    assert without_duplicates(record, BOTH).time.tolist() == pytest.approx([0.0, 0.2, 0.4, 0.5])
    assert without_duplicates(record, ["u"]).time.tolist() == pytest.approx([0.0, 0.2, 0.5])


def test_a_missing_value_equals_nothing() -> None:
    assert first_occurrences(np.array([[NAN, 1.0], [NAN, 1.0], [2.0, 1.0], [2.0, 1.0]])).tolist() == [1, 1, 1, 0]


def test_infinities_are_outliers_and_missing_values_are_not() -> None:
    record = of([1.0, np.inf, 2.0, NAN, 3.0, -np.inf])
    np.testing.assert_array_equal(without_outliers(record, 3.0, ["u"])["u"], [1.0, 2.0, NAN, 3.0])
    np.testing.assert_array_equal(without_missing(record, ["u"])["u"], [1.0, 2.0, 3.0])


def test_a_sample_without_a_stamp_is_missing() -> None:
    record = Record("run", np.array([0.0, NAN, 0.2]), {"u": Channel.from_notation("u", np.ones(3))})
    assert without_missing(record, ["u"]).time.tolist() == [0.0, 0.2]


def test_a_hole_leaves_the_time_base_uneven() -> None:
    cleaned = without_missing(of([1.0, 2.0, NAN, 4.0, 5.0]), ["u"])
    assert not cleaned.is_uniform
    with pytest.raises(InputError, match="uneven time base"):
        _ = cleaned.dt


def test_the_threshold_itself_stays() -> None:
    assert without_small(of([0.5, -0.5, 0.49, 0.0]), {"u": 0.5})["u"].tolist() == [0.5, -0.5]
    assert len(without_small(of([0.5, 0.0]), {"u": 0.0})) == 2


@pytest.mark.parametrize(
    ("step", "said"),
    [
        (lambda r: without_outliers(r, 3.0, ["v"]), "channel 'v' is constant at 2 m/s.*leave it out"),
        (lambda r: without_outliers(r, 3.0, ["r"]), "channel 'r' holds no value; leave it out"),
        (lambda r: without_outliers(r, 0.0, ["u"]), "limit of standard scores is 0; give one above 0"),
        (lambda r: without_outliers(r, NAN, ["u"]), "limit of standard scores is nan; give one above 0"),
        (lambda r: without_outliers(r, 0.5, ["u"]), "all 4 samples would go .*score above 0.5 in u.*change limits"),
        (lambda r: without_outliers(r, 3.0, []), "without_outliers was given no channel"),
        (lambda r: without_duplicates(r, []), "without_duplicates was given no channel"),
        (lambda r: without_missing(r, []), "without_missing was given no channel"),
        (lambda r: without_missing(r, ["u", "r"]), "all 4 samples would go .*missing values in u, r"),
        (lambda r: without_small(r, {}), "without_small was given no channel"),
        (lambda r: without_small(r, {"u": 3.0}), r"all 4 samples would go .*\|u\| < 3 m/s"),
        (lambda r: without_small(r, {"u": -1.0}), "threshold of channel 'u' is -1; give a size in m/s"),
        (lambda r: without_small(r, {"u": NAN}), "threshold of channel 'u' is nan; give a size in m/s"),
        (lambda r: without_small(r, {"w": 1.0}), "'run' has no channel 'w'"),
        (lambda r: without_outliers(r, 3.0, ["w"]), "'run' has no channel 'w'"),
        (lambda r: without_duplicates(r, ["w"]), "'run' has no channel 'w'"),
        (lambda r: without_missing(r, ["w"]), "'run' has no channel 'w'"),
    ],
)
def test_what_makes_no_sense_is_refused_in_a_sentence(step: Step, said: str) -> None:
    values = {"u": np.array([1.0, -1.0, 1.0, -1.0]), "v": np.full(4, 2.0), "r": np.full(4, NAN)}
    with pytest.raises(InputError, match=said) as refusal:
        step(Record.from_arrays("run", np.arange(4.0), values))
    assert "'run'" in str(refusal.value)
    assert "\n" not in str(refusal.value)


def test_constant_up_to_rounding_is_constant() -> None:
    record = of([0.3, 0.1 + 0.2, 0.3, 0.3])
    with pytest.raises(InputError, match="constant"):
        without_outliers(record, 3.0, ["u"])
