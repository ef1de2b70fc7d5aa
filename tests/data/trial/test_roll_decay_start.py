"""A decay from its release on; what cannot be one is refused."""

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.data.trial.records import need_release, require_decay, trim_to_decay_start

TIME = np.arange(0.0, 60.0, 0.05)


def decay(start: float = 0.15, noise: float = 0.0, damping: float = 0.03, rest: float = 0.002) -> Record:
    """Ten seconds at rest, heeled by hand, released at 15 s."""
    swing = np.where(TIME < 15.0, 0.0, np.exp(-damping * (TIME - 15.0)) * np.cos(2.5 * (TIME - 15.0)))
    held = np.where((TIME >= 10.0) & (TIME < 15.0), (TIME - 10.0) / 5.0, 0.0)
    phi = rest + start * (swing + held) + noise * np.random.default_rng(3).standard_normal(len(TIME))
    return Record.from_arrays("decay", TIME, {"phi": phi})


def test_what_lies_before_the_release_goes() -> None:
    """The largest angle stands at 15 s, to either side; the step says so."""
    for start in (0.15, -0.15):
        kept = trim_to_decay_start(decay(start, noise=1e-4))
        assert kept.time[0] == pytest.approx(15.0, abs=0.1)
        assert kept.time[-1] == TIME[-1]
        assert "from its release on" in kept.provenance.steps[-1]


def test_records_need_their_release_where_one_begins_before_it() -> None:
    from_release = trim_to_decay_start(decay())
    assert need_release([from_release, decay()]) and not need_release([from_release])
    assert not need_release([decay(), decay(damping=0.0)])


def test_an_angle_that_is_held_long_is_cut_at_the_release(rng: np.random.Generator) -> None:
    """Five seconds at one angle within the noise: the largest of them is any sample of the hold."""
    swing = np.where(TIME < 5.0, 1.0, np.exp(-0.03 * (TIME - 5.0)) * np.cos(2.5 * (TIME - 5.0)))
    phi = 0.2 * swing + 1e-3 * rng.standard_normal(len(TIME))
    record = Record.from_arrays("decay", TIME, {"phi": phi})
    kept = trim_to_decay_start(record)
    assert kept.time[0] == pytest.approx(5.0, abs=0.1)


@pytest.mark.parametrize(
    ("record", "said"),
    [
        (decay(start=0.001, noise=0.01), "within the noise"),
        (decay(damping=0.0), "does not decay: 8.7 deg in its first third, 8.7 deg in its last"),
        (
            Record.from_arrays("decay", TIME, {"phi": 0.002 * np.exp(0.07 * TIME) * np.cos(2.5 * TIME)}),
            "the roll grows, to 7.1 deg at 59",
        ),
        (decay(start=8.6), "the decay starts at 494.2 deg, beyond 90 deg of heel; check the unit"),
        (Record.from_arrays("decay", TIME[:3], {"phi": np.zeros(3)}), "3 rows are no decay"),
        (decay().without("phi"), "needs the roll angle 'phi'"),
        (Record.from_arrays("decay", TIME, {"phi": np.where(TIME > 59.8, 0.1, 0.0)}), "nothing is left of the decay"),
    ],
)
def test_what_is_no_decay_is_refused(record: Record, said: str) -> None:
    """One sentence, naming the record."""
    with pytest.raises(InputError, match=f"record 'decay'.*{said}"):
        trim_to_decay_start(record)


@pytest.mark.parametrize("growth", [0.0, 0.01])
def test_a_motion_that_lasts_is_no_decay(growth: float) -> None:
    """Constant or growing amplitude, whether or not a release was sought; a decay passes."""
    lasting = Record.from_arrays("run", TIME, {"phi": 0.1 * np.exp(growth * TIME) * np.cos(2.5 * TIME)})
    with pytest.raises(InputError, match="record 'run': the roll does not decay"):
        require_decay(lasting)
    require_decay(trim_to_decay_start(decay()))


def test_a_decay_that_people_swung_up_begins_at_their_last_swing() -> None:
    size = np.where(TIME < 30.0, 0.2 + 0.8 * TIME / 30.0, np.exp(-0.1 * (TIME - 30.0)))
    phi = 0.18 * size * np.cos(2.5 * (TIME - 30.0))
    record = Record.from_arrays("decay", TIME, {"phi": phi})
    assert need_release([record])
    assert trim_to_decay_start(record).time[0] == pytest.approx(30.0, abs=0.1)
