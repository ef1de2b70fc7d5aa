"""Repair: wild samples, held positions, holes; every change is reported and nothing else is touched."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.data.check.ship import with_values, zigzag

from seatrial.core.values import InputError
from seatrial.data.check import repair
from seatrial.data.check.repair import repaired_parts


def spoilt(symbol: str, rows: slice | list[int], value: float | np.ndarray):
    values = np.array(zigzag(noise=1.0)[symbol])
    values[rows] = values[rows] + value
    return with_values(zigzag(noise=1.0), **{symbol: values})


@pytest.mark.parametrize("noise", [0.0, 1.0, 3.0])
def test_a_sound_record_is_untouched(noise: float) -> None:
    record, findings = repair(zigzag(noise=noise))
    assert findings == ()
    np.testing.assert_array_equal(record["u"], zigzag(noise=noise)["u"])


@given(st.integers(20, 2980), st.sampled_from([("x0", 5.0), ("psi", 0.5), ("u", -0.8), ("r", 0.2)]))
@settings(max_examples=25)
def test_single_wild_samples_are_interpolated(row: int, what: tuple[str, float]) -> None:
    symbol, size = what
    record, findings = repair(spoilt(symbol, [row], size))
    assert [f.code for f in findings] in (["outlier"], ["outlier", "jump"]) and f"'{symbol}'" in findings[0].message
    changed = np.flatnonzero(record[symbol] != zigzag(noise=1.0)[symbol])
    assert changed.tolist() == [row]
    assert abs(record[symbol][row] - zigzag(noise=1.0)[symbol][row]) < 0.1


def test_a_rudder_step_is_no_outlier() -> None:
    delta = np.zeros(3000)
    delta[1500] = 0.5
    record, findings = repair(with_values(zigzag(), delta=delta))
    assert findings == () and record["delta"][1500] == 0.5


def test_a_held_position_that_catches_up_is_interpolated() -> None:
    record = zigzag()
    x, y = np.array(record["x0"]), np.array(record["y0"])
    x[500:508], y[500:508] = x[499], y[499]
    mended, findings = repair(with_values(record, x0=x, y0=y))
    assert [f.code for f in findings] == ["jump"] and "8 held samples before a jump interpolated" in findings[0].message
    np.testing.assert_allclose(mended["x0"], record["x0"], atol=0.01)


def test_a_jump_that_stays_is_reported_not_hidden() -> None:
    mended, findings = repair(spoilt("x0", slice(1000, None), 4.0))
    assert [f.code for f in findings] == ["jump"] and "cannot be repaired" in findings[0].message
    assert mended["x0"][1500] == pytest.approx(zigzag(noise=1.0)["x0"][1500] + 4.0)


def test_short_holes_are_interpolated_on_the_shorter_arc() -> None:
    psi = (np.linspace(0.0, 20.0, 3000) + np.pi) % (2 * np.pi) - np.pi
    wrap = int(np.flatnonzero(np.abs(np.diff(psi)) > np.pi)[0])
    holed = psi.copy()
    holed[wrap - 2 : wrap + 4] = np.nan
    record, findings = repair(with_values(zigzag(), psi=holed))
    assert [f.code for f in findings] == ["empty-cells"] and "psi 6" in findings[0].evidence
    np.testing.assert_allclose(np.exp(1j * record["psi"]), np.exp(1j * psi), atol=1e-9)


def test_a_hole_of_one_output_is_not_measured_and_cuts_nothing() -> None:
    record, findings = repair(spoilt("u", slice(700, 900), np.nan))
    assert len(record) == 3000 and np.isnan(record.channel("u").measured).sum() == 200
    assert [f.code for f in findings] == ["empty-cells"] and "u 200" in findings[0].evidence


def test_of_a_record_with_a_long_hole_of_an_input_the_longest_part_is_kept() -> None:
    record, findings = repair(spoilt("delta", slice(700, 900), np.nan))
    assert len(record) == 2100 and record.time[0] == pytest.approx(90.0)
    assert findings[-1].code == "empty-rows" and "2 complete parts" in findings[-1].message
    assert [len(part) for part in repaired_parts(spoilt("delta", slice(700, 900), np.nan))[0]] == [700, 2100]


def test_a_channel_without_values_is_refused() -> None:
    with pytest.raises(InputError, match="channel 'v' holds no value"):
        repair(spoilt("v", slice(None), np.nan))
