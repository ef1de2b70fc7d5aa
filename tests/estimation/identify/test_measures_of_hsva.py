"""The tanker's zigzags simulated open loop drift off by degrees; their overshoots can be compared all the same."""

from pathlib import Path

import pytest

from seatrial.data.trial import load_trial
from seatrial.estimation.identify import identify


@pytest.mark.long
def test_every_measured_overshoot_has_a_simulated_one(
    data_folder: Path, repository: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder))
    fit = identify(load_trial(repository / "examples" / "kvlcc2_hsva.toml"))
    assert len(fit.predictions) == 13
    for p in fit.predictions:
        found = {k: m for k, m in p.measures.items() if k.startswith("overshoot_")}
        assert len(found) >= 2
        assert all(m.measured is not None and m.simulated is not None for m in found.values())
        assert found["overshoot_1_deg"].simulated == pytest.approx(found["overshoot_1_deg"].measured, abs=4.0)
