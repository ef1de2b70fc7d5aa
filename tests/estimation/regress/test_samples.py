"""Cleaning and splitting: what goes is what the equation says, pieces make the whole, nothing is invented."""

import math
import re
from collections.abc import Callable
from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from seatrial.core.values import Array, Channel, InputError, Record, RecordKind
from seatrial.data.example_series import simulate_run, true_model
from seatrial.estimation.regress.samples import (
    blocks,
    first_occurrences,
    folds,
    manoeuvre_seconds,
    record_folds,
    shuffled_split,
    standard_scores,
    training_rows,
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


shares = st.floats(0.01, 0.99)
PERIOD = 40.0


@cache
def zigzags() -> Record:
    """Ten executes of the waterjet craft, 755 s, without noise."""
    return simulate_run(true_model(), "consecutive-zigzags:2")


def weaving(seconds: float, dt: float = 0.1) -> Record:
    """A rudder turned as a sine, period 40 s, never held; the heading follows."""
    time = dt * np.arange(round(seconds / dt) + 1)
    phase = 2.0 * np.pi * time / PERIOD
    values = {"delta": 0.2 * np.sin(phase), "psi": 0.4 * np.sin(phase - 1.0)}
    return Record.from_arrays("weaving", time, values, RecordKind.SIMULATED)


@given(rows=st.integers(2, 400), share=shares)
def test_blocks_partition_the_record_in_order(rows: int, share: float) -> None:
    assume(0 < round(share * rows) < rows)
    record = Record.from_arrays("run", np.cumsum(np.ones(rows)), {"u": np.arange(float(rows))}, RecordKind.SIMULATED)
    train, test = blocks(record, share)
    np.testing.assert_array_equal(np.concatenate([train["u"], test["u"]]), record["u"])
    np.testing.assert_array_equal(np.concatenate([train.time, test.time]), record.time)
    assert len(train) == training_rows(rows, share)
    assert abs(len(train) - share * rows) <= 0.5
    assert {train.kind, test.kind} == {RecordKind.SIMULATED}


def test_the_published_split_puts_16800_of_21000_samples_into_training() -> None:
    assert training_rows(21000, 0.8) == 16800


def test_blocks_say_which_samples_they_are() -> None:
    train, test = blocks(weaving(200.0), 0.5)
    assert train.provenance.steps == ("training block: samples 1 to 1000 of 2001",)
    assert test.provenance.steps == ("test block: samples 1001 to 2001 of 2001",)


@given(rows=st.integers(2, 500), count=st.integers(2, 40))
def test_folds_partition_the_rows_in_order_and_nearly_equally(rows: int, count: int) -> None:
    assume(count <= rows)
    made = folds(rows, count)
    assert len(made) == count
    np.testing.assert_array_equal(np.concatenate(made), np.arange(rows))
    assert max(map(len, made)) - min(map(len, made)) <= 1


@given(rows=st.integers(2, 300), share=shares, seed=st.integers(0, 5))
def test_shuffled_rows_are_every_row_once_and_repeatable(rows: int, share: float, seed: int) -> None:
    assume(0 < round(share * rows) < rows)
    train, test = shuffled_split(rows, share, np.random.default_rng(seed))
    assert len(train) == training_rows(rows, share)
    np.testing.assert_array_equal(np.sort(np.concatenate([train, test])), np.arange(rows))
    assert np.all(np.diff(train) > 0)
    assert np.all(np.diff(test) > 0)
    again = shuffled_split(rows, share, np.random.default_rng(seed))
    np.testing.assert_array_equal(train, again[0])


def copied(train: Array, test: Array, values: Array) -> float:
    """Error of predicting each test row by the nearest row for training, against the deviation of the test rows."""
    right = np.clip(np.searchsorted(train, test), 1, len(train) - 1)
    near = np.where(test - train[right - 1] <= train[right] - test, train[right - 1], train[right])
    return float(np.sqrt(np.mean((values[near] - values[test]) ** 2)) / np.std(values[test]))


def test_shuffling_leaks_and_blocks_do_not(rng: np.random.Generator) -> None:
    """Copying the neighbour, which knows no ship, predicts shuffled rows to a hundredth and blocks not at all."""
    r = zigzags()["r"]
    first, rows = training_rows(len(r), 0.7), np.arange(len(r))
    assert copied(*shuffled_split(len(r), 0.7, rng), r) < 0.01
    assert copied(rows[:first], rows[first:], r) > 0.9


def test_longest_manoeuvre_of_zigzags_is_the_longest_cycle_of_heading() -> None:
    """Two executes lie between extremes to the same side; the executes are known from the rudder."""
    record = zigzags()
    moved = np.flatnonzero(np.diff(np.sign(record["delta"])) != 0)
    gaps = np.diff(record.time[moved])
    longest = manoeuvre_seconds(record)
    assert np.max(gaps) < longest < 2.0 * np.max(gaps)
    assert longest == pytest.approx(np.max(gaps[gaps > 1.0][1:] + gaps[gaps > 1.0][:-1]), rel=0.05)


def test_longest_manoeuvre_of_a_rudder_never_held_is_the_period_of_heading() -> None:
    assert manoeuvre_seconds(weaving(200.0)) == pytest.approx(PERIOD, abs=0.1 + 1e-9)


def test_longest_manoeuvre_of_two_executes_is_the_time_between_them() -> None:
    """The heading turns back once only, so that no cycle is seen."""
    time = 0.5 * np.arange(300)
    delta = np.select([time < 10.0, time < 70.0], [0.0, 0.3], -0.3)
    psi = np.radians(np.interp(time, [0.0, 10.0, 80.0, 150.0], [0.0, 0.0, 30.0, 5.0]))
    record = Record.from_arrays("begun", time, {"delta": delta, "psi": psi})
    assert manoeuvre_seconds(record) == pytest.approx(60.0, abs=0.5)


@pytest.mark.parametrize("positive", ["starboard", "port"])
def test_longest_manoeuvre_of_a_turning_circle_is_one_circle(positive: str) -> None:
    """A steady turn of 3 deg/s, begun at 20 s: 120 s, to either side and over the jump of a compass at 360 deg."""
    time = 0.5 * np.arange(500)
    turned = np.radians(3.0) * np.maximum(time - 20.0, 0.0)
    psi = np.mod(1.0 + turned, 2.0 * np.pi)
    rudder = np.where(time >= 20.0, 0.3, 0.0)
    channels = {"psi": Channel(psi, "rad", "earth", positive), "delta": Channel(rudder, "rad", "body", positive)}
    assert manoeuvre_seconds(Record("circle", time, channels)) == pytest.approx(120.0, abs=1.0)
    half = Record("circle", time, channels).between(0.0, 110.0)
    assert manoeuvre_seconds(half) == pytest.approx(90.0, abs=1.0)


def test_manoeuvres_are_seen_through_noise_and_holes(rng: np.random.Generator) -> None:
    clean = zigzags()
    noise = math.radians(0.2) * rng.standard_normal(len(clean))
    noisy = clean.with_channel("psi", clean.channel("psi").with_values(clean["psi"] + noise))
    cleaned = without_small(noisy, {"v": 2e-3, "r": 2e-3})
    assert len(cleaned) < 0.95 * len(clean)
    assert not cleaned.is_uniform
    for record in (noisy, cleaned):
        assert manoeuvre_seconds(record) == pytest.approx(manoeuvre_seconds(clean), rel=0.03)


def test_without_rudder_or_heading_no_manoeuvre_is_demanded() -> None:
    record = zigzags().without("delta")
    assert manoeuvre_seconds(record) == 0.0
    assert manoeuvre_seconds(zigzags().without("psi")) == 0.0
    assert len(blocks(record, 0.99)[1]) == len(record) - round(0.99 * len(record))


def test_a_block_shorter_than_a_manoeuvre_is_refused_with_both_lengths() -> None:
    said = (
        r"record 'consecutive-zigzags_2': the test block would be 151 s long \(1511 samples\), shorter than the "
        r"longest manoeuvre in the record, 165.9 s; take a share between 0.22 and 0.78$"
    )
    with pytest.raises(InputError, match=said):
        blocks(zigzags(), 0.8)
    with pytest.raises(InputError, match="the training block would be"):
        blocks(zigzags(), 0.1)


@given(seconds=st.floats(30.0, 300.0), share=shares)
def test_both_blocks_hold_a_manoeuvre_or_the_advice_helps(seconds: float, share: float) -> None:
    record = weaving(seconds, dt=0.5)
    longest = manoeuvre_seconds(record)
    try:
        assert min(piece.duration for piece in blocks(record, share)) >= longest
    except InputError as refusal:
        advised = [float(number) for number in re.findall(r"\b0\.\d\d\b", str(refusal).rpartition(";")[2])]
        for other in advised:
            assert min(piece.duration for piece in blocks(record, other)) >= longest
        if not advised:
            assert "take a longer record" in str(refusal)
            assert record.duration < 2.1 * longest


@given(seconds=st.floats(30.0, 300.0), count=st.integers(2, 12))
def test_every_fold_of_a_record_holds_a_manoeuvre_or_the_advice_helps(seconds: float, count: int) -> None:
    record = weaving(seconds, dt=0.5)
    longest = manoeuvre_seconds(record)
    try:
        assert all(record.time[f[-1]] - record.time[f[0]] >= longest for f in record_folds(record, count))
    except InputError as refusal:
        fewer = re.search(r"give (\d+) folds at most", str(refusal))
        if fewer:
            assert len(record_folds(record, int(fewer[1]))) < count
        else:
            assert record.duration < 2.1 * longest
        assert f"shortest of {count} folds would be" in str(refusal)
        assert f"longest manoeuvre in the record, {longest:.4g} s" in str(refusal)


@pytest.mark.parametrize("share", [0.0, 1.0, -0.2, 1.5, float("nan")])
def test_a_share_must_lie_between_nothing_and_all(share: float) -> None:
    with pytest.raises(InputError, match=r"share for training is .*; give one between 0 and 1"):
        blocks(weaving(200.0), share)


def test_no_piece_may_be_empty() -> None:
    with pytest.raises(InputError, match="puts 0 of 3 rows there; give more rows"):
        training_rows(3, 0.1)
    with pytest.raises(InputError, match="puts 3 of 3 rows there; give more rows"):
        training_rows(3, 0.9)
    for count in (-1, 0, 1, 8):
        with pytest.raises(InputError, match=f"7 rows cannot be cut into {count} folds; give between 2 and 7"):
            folds(7, count)


def test_missing_stamps_are_refused() -> None:
    time = np.array([0.0, 1.0, float("nan"), 3.0])
    channels = {symbol: Channel.from_notation(symbol, np.zeros(4)) for symbol in ("psi", "delta")}
    with pytest.raises(InputError, match="stamps are missing; rebuild its time base"):
        blocks(Record("run", time, channels), 0.5)
