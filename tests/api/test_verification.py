"""`verify` takes values or paths; a log of nothing is refused."""

from pathlib import Path

import numpy as np
import pytest

import seatrial as st
from seatrial.api import verify
from seatrial.core.values import InputError


def test_it_is_the_public_function_and_refuses_a_log_without_the_channels(repository: Path) -> None:
    record = st.Record.from_arrays("log", 0.1 * np.arange(100), {"phi": np.zeros(100)})
    assert st.verify is verify
    with pytest.raises(InputError, match="alpha_f"):
        verify(repository / "examples" / "fin_stabiliser.toml", {"KP": 1.0, "KI": 1.0, "KD": 1.0}, [record])
