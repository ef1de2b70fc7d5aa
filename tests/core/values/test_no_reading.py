"""Values that stand for no reading lie far outside all others, again and again."""

import numpy as np

from seatrial.core.values.no_reading import sentinel_value


def test_only_what_recurs_far_outside_is_no_reading() -> None:
    values = np.linspace(-1.0, 1.0, 50)
    assert sentinel_value(np.append(values, [-999.0, -999.0])) == -999.0
    assert sentinel_value(np.append(values, [1e6, np.nan, 1e6])) == 1e6
    assert sentinel_value(np.append(values, -999.0)) is None and sentinel_value(values) is None
