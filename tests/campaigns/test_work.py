"""Identities of tasks: the same content has the same one, anything else another."""

import pytest
from tests.campaigns.tasks import squares, work

from seatrial.campaigns import Work
from seatrial.campaigns.work import MAX_TASKS, canonical_json, packed, unpacked
from seatrial.core.values import InputError


def identities(one: Work) -> list[bytes]:
    return [task.identity for task in one.tasks()]


def test_identities_depend_on_content_not_on_the_order_of_keys() -> None:
    one = Work({"a": 1, "b": 2}, [{"x": 1, "seed": 0}], squares, versions={"seatrial": "1"})
    same = Work({"b": 2, "a": 1}, [{"seed": 0, "x": 1}], squares, versions={"seatrial": "1"})
    assert identities(one) == identities(same)
    for other in (
        Work({"a": 1, "b": 3}, [{"x": 1, "seed": 0}], squares, versions={"seatrial": "1"}),
        Work({"a": 1, "b": 2}, [{"x": 2, "seed": 0}], squares, versions={"seatrial": "1"}),
        Work({"a": 1, "b": 2}, [{"x": 1, "seed": 0}], squares, versions={"seatrial": "2"}),
    ):
        assert identities(one) != identities(other)


def test_the_content_of_a_trial_is_part_of_its_tasks_alone() -> None:
    keys = [{"trial": "a"}, {"trial": "b"}]
    one = Work({}, keys, squares, contents={"a": "1", "b": "2"})
    other = Work({}, keys, squares, contents={"a": "1", "b": "3"})
    assert [x == y for x, y in zip(identities(one), identities(other), strict=True)] == [True, False]


def test_more_seeds_keep_the_identities_of_the_first_ones() -> None:
    assert identities(work(5)) == identities(work(9))[:5]


def test_identities_survive_packing() -> None:
    ids = identities(work(4))
    assert unpacked(packed(ids)) == ids


def test_numbers_in_canonical_json_are_exact() -> None:
    assert canonical_json({"b": 0.1 + 0.2, "a": "å"}) == '{"a":"å","b":0.30000000000000004}'.encode()


def test_absurd_numbers_of_tasks_are_refused() -> None:
    with pytest.raises(InputError, match="has no task"):
        work(0).tasks()
    with pytest.raises(InputError, match="more than the 1,000,000"):
        Work({}, range(MAX_TASKS + 1), squares).tasks()  # type: ignore[arg-type]
    with pytest.raises(InputError, match="1 tasks of the campaign occur twice"):
        Work({}, [{"seed": 1}, {"seed": 1}], squares).tasks()
