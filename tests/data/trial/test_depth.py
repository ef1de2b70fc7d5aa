"""The depth of the water in a trial: what one depth leaves open is said, and a depth below the keel is refused."""

from collections.abc import Sequence

import numpy as np
import pytest

from seatrial.core.values import InputError, Ship
from seatrial.data.trial import EstimateMethod, EstimateSettings, Run, Trial
from seatrial.data.trial.load import build_trial_model
from seatrial.data.trial.records import load_records
from seatrial.data.trial.schema import ModelTable
from seatrial.estimation.identify import identify
from seatrial.physics.models.published import SHARE_SPREAD, kvlcc2_l7, share_name
from seatrial.problems.twin_ships import shallow_water_ship, shallow_water_trials


def trial(depths: Sequence[float], free: Sequence[str], rng: np.random.Generator) -> Trial:
    """Trials of the 7 m tanker at these depths over draught."""
    model = shallow_water_ship()
    known = shallow_water_trials(model.with_parameters(model.parameters.only_free(tuple(free))), depths)
    settings = EstimateSettings(method=EstimateMethod.OUTPUT_ERROR)
    return Trial(
        Ship("tanker", {"L": 7.0}), tuple(map(Run, known.noisy(rng))), known.model, settings, dict(known.noise)
    )


@pytest.mark.long
def test_one_depth_does_not_tell_a_coefficient_from_its_change_with_depth(rng: np.random.Generator) -> None:
    with pytest.raises(InputError, match=r"do not determine the direction .*(N_v .*h_N_v|h_N_v .*N_v)"):
        identify(trial((1.5,), ("N_v", "N_r", "h_N_v"), rng))


@pytest.mark.long(every=2)
def test_two_depths_do(rng: np.random.Generator) -> None:
    fit = identify(trial((0.0, 1.5), ("N_v", "N_r", "h_N_v"), rng))
    found = {c.name: c for c in fit.coefficients}
    for name, value in (("N_v", -0.137), ("h_N_v", 1.2)):
        assert found[name].lower < value < found[name].upper
        assert found[name].estimate == pytest.approx(value, rel=0.1)


def test_a_depth_below_the_keel_is_refused_with_the_edit(rng: np.random.Generator) -> None:
    of_keel = trial((0.5,), ("N_v",), rng)
    with pytest.raises(InputError, match=r"0\.23 m deep where the ship draws 0\.46 m.*offset = 0\.46 under channels"):
        load_records(of_keel)


def test_the_source_shallow_gives_every_share_its_spread() -> None:
    form = {name: kvlcc2_l7().ship.particulars[name] for name in ("L", "B", "d", "C_b", "A_R", "H_R", "D_P")}
    sources = ["yoshimura", "zhou", "interaction", "propulsion", "displacement", "shallow"]
    table = ModelTable(name="mmg_shallow", priors_from=sources, prior_sd_percent=50.0)
    parameters = build_trial_model(table, Ship("tanker", form)).parameters
    for name, spread in SHARE_SPREAD.items():
        prior = parameters[share_name(name)].prior
        assert prior is not None
        assert (prior.mean, prior.standard_deviation) == (1.0, spread)
        assert not parameters[share_name(name)].free
