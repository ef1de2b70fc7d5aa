"""A model file with everything that exports repeat, and the compiler."""

import shutil

import numpy as np
import pytest

import seatrial as st
from seatrial.core.results import IntervalBasis
from seatrial.data.folder.model_file import ModelFile, ModelProvenance, RecordSource
from seatrial.physics.models.published import kvlcc2

ENVELOPE = {"yaw_rate": 0.06, "drift": 0.2, "rudder": 0.5, "fastest": 1.2, "slowest": 0.75}
"""rad/s, rad, rad, m/s, m/s: what zigzags of a 7 m model cover."""


@pytest.fixture(scope="session")
def kvlcc2_file() -> ModelFile:
    """KVLCC2 with a range, records, and texts that would end a comment."""
    model = kvlcc2()
    model = model.with_parameters(model.parameters.only_free(["Y_v", "N_v"]))
    ship = st.Ship("tanker */ \n#error --> ??/ \\", {"L": 7.0}, 'source """', 45.7)
    provenance = ModelProvenance(
        (RecordSource("z_20_20", "training", "ab" * 32),), "output error", 1, {"seatrial": "0"}
    )
    basis = IntervalBasis(np.diag([1e-4, 1e-5]), 100.0, 1.0, training_envelope=dict(ENVELOPE))
    return ModelFile(model, np.diag([1e-4, 1e-5]), provenance, ship, {"u": 1.1, "n": 10.2}, basis)


@pytest.fixture(scope="session")
def compiler() -> str:
    """The machine's C compiler."""
    found = shutil.which("gcc")
    if found is None:
        pytest.skip("no gcc on this machine; install it to compile exported sources")
    return found
