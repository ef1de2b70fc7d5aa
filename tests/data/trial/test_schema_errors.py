"""Wrong settings written in Python are refused in one sentence, as those of a trial file."""

from collections.abc import Callable
from dataclasses import replace

import pytest

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout
from seatrial.data.trial.design_request import DesignRequest, InputRange
from seatrial.data.trial.settings import EstimateSettings, ModelFamily, Stream, StreamSource

RUDDER = InputRange(lower=-0.6, upper=0.6, unit="rad", hold=4.0)
REQUEST = DesignRequest(duration=600.0, rate=5.0, inputs={"delta": RUDDER})
STREAM = Stream(source=StreamSource.STDIN, rate=10.0, layout=Layout("text", ColumnSpec("time", 1, "s"), ()))


def family_of(keys: dict[str, object]) -> ModelFamily:
    return ModelFamily(**keys)  # type: ignore[arg-type]


@pytest.mark.parametrize(
    ("write", "sentence"),
    [
        (lambda: EstimateSettings(rate=-1.0), "EstimateSettings: rate = -1.0: input should be greater than 0"),
        (
            lambda: EstimateSettings(segment_s=1.0, segment_lengths=1.0),
            "EstimateSettings: segment_s and segment_lengths are both given; keep one",
        ),
        (lambda: replace(EstimateSettings(), current=-0.1), "EstimateSettings: current = -0.1: input should be"),
        (lambda: family_of({"structure": {}}), "ModelFamily: unknown key 'structure'; did you mean"),
        (lambda: replace(RUDDER, upper=-0.7), "InputRange: lower = -0.6 is not below upper = -0.7"),
        (lambda: replace(REQUEST, duration=-1.0), "DesignRequest: duration: -1 is not positive"),
        (lambda: replace(STREAM, rate=0.0), "Stream: rate = 0.0: input should be greater than 0"),
        (lambda: replace(STREAM, source=StreamSource.UDP), "Stream: source = 'udp' needs a port; add it"),
        (lambda: replace(REQUEST, inputs={}), "DesignRequest: inputs is an empty table; give at least one entry"),
    ],
)
def test_wrong_settings_in_python_are_refused_by_class_and_key(write: Callable[[], object], sentence: str) -> None:
    with pytest.raises(InputError) as raised:
        write()
    assert str(raised.value).startswith(sentence)
    assert "\n" not in str(raised.value)


def test_right_settings_in_python_are_kept() -> None:
    assert REQUEST.with_hold(8.0).inputs["delta"] == replace(RUDDER, hold=8.0)
    assert EstimateSettings(offsets={"r": 0.1}) == replace(EstimateSettings(), offsets={"r": 0.1})
