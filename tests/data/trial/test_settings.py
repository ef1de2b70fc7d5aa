"""`[estimate] method` and `[estimate.search]`: names, ends of ranges, and the key that was renamed."""

from collections.abc import Callable

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import (
    SEARCHES,
    EstimateMethod,
    EstimateSettings,
    FitCriterion,
    SearchFitness,
    SearchSettings,
)


def test_a_published_method_leaves_the_criterion_to_the_decision_table() -> None:
    assert EstimateSettings(method=EstimateMethod.OUTPUT_ERROR).criterion is FitCriterion.OUTPUT_ERROR
    assert EstimateSettings(method=EstimateMethod.IWHO).criterion is FitCriterion.AUTO
    assert [m for m in EstimateMethod if m.is_search] == list(SEARCHES)
    assert [m.value for m in EstimateMethod if not m.is_published] == [c.value for c in FitCriterion]


def settings_of(keys: dict[str, object]) -> EstimateSettings:
    return EstimateSettings(**keys)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("write", "sentence"),
    [
        (lambda: settings_of({"criterion": "output-error"}),
         "EstimateSettings: unknown key 'criterion', which is 'method' now; write method = \"output-error\""),
        (lambda: settings_of({"method": "iwhoo"}),
         "EstimateSettings: method: unknown method 'iwhoo'; did you mean 'iwho'?"),
        (lambda: SearchSettings(bounds={"a33": (2.0, 1.0)}),
         "SearchSettings: the bounds of a33 run from 2 to 1; write a33 = [1, 2]"),
        (lambda: SearchSettings(bounds={"a33": (2.0, 2.0)}),
         "SearchSettings: both bounds of a33 are 2; widen them, or fix a33 under [model]"),
        (lambda: SearchSettings(restarts=0), "SearchSettings: restarts = 0: input should be greater than"),
    ],
)  # fmt: skip
def test_wrong_names_and_ranges_are_refused_with_the_edit(write: Callable[[], object], sentence: str) -> None:
    with pytest.raises(InputError) as raised:
        write()
    assert str(raised.value).startswith(sentence)


def test_a_search_is_written_as_a_table() -> None:
    table = {"population": 20, "fitness": "sample", "bounds": {"a33": [1.0, 2.0]}}
    search = settings_of({"method": "iwho", "search": table}).search
    assert search == SearchSettings(population=20, fitness=SearchFitness.SAMPLE, bounds={"a33": (1.0, 2.0)})
