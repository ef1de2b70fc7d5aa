"""Monte Carlo campaigns: the bound is that of the information, errors have its size, bad truths are refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from seatrial.campaigns import Work, open_store
from seatrial.campaigns.montecarlo_work import NoisyRepeats, with_noise
from seatrial.campaigns.plan import plan_schema
from seatrial.campaigns.run_campaign import CampaignOptions, run_campaign, work_of_plan
from seatrial.campaigns.summary import campaign_summary, campaign_table
from seatrial.core.values import InputError

PLAN = """
kind = "montecarlo"
seeds = 4
manoeuvres = ["zigzag:20/20"]
rudder_rate = { value = 4, unit = "deg/s" }
inputs = { v_j = 1.866 }
rate = 2.0
[ship]
name = "waterjet craft"
L = 9.8
d = 0.71
m = 5540.0
[model]
name = "waterjet"
free = ["Y_v", "Y_r", "N_v", "N_r"]
[noise]
u = 0.02
v = 0.02
r = { value = 0.1, unit = "deg/s" }
psi = { value = 0.2, unit = "deg" }
"""


def plan(folder: Path, text: str = PLAN) -> Path:
    path = folder / "plan.toml"
    path.write_text(text)
    return path


@pytest.fixture(scope="module")
def work(tmp_path_factory: pytest.TempPathFactory) -> Work:
    return work_of_plan(plan(tmp_path_factory.mktemp("plan")))


def test_errors_have_the_size_of_the_bound(work: Work, tmp_path: Path) -> None:
    run_campaign(work, tmp_path / "store", CampaignOptions(workers=1))
    store = open_store(tmp_path / "store")
    summary = campaign_summary(store, campaign_table(store))
    assert [c.truth for c in summary.coefficients] == pytest.approx([-0.2767, 0.08811, -0.1708, -0.0524], rel=1e-3)
    ratios = [c.rmse_over_bound or 0.0 for c in summary.coefficients]
    # chi-square of 16 errors, though not independent ones: mean square within a factor of 3
    assert 1 / 3 < float(np.mean(np.square(ratios))) < 3
    assert sum(c.covered for c in summary.coefficients) >= 12


def test_a_seed_does_not_depend_on_the_others(work: Work, tmp_path: Path) -> None:
    later = work_of_plan(plan(tmp_path, PLAN.replace("seeds = 4", "seeds = 1\nfirst_seed = 3")))
    assert later.tasks()[0].identity == work.tasks()[3].identity
    assert later.function(later.keys[0]) == work.function(work.keys[3])


def test_noise_has_the_deviation_that_is_stated(work: Work) -> None:
    repeats = work.function
    assert isinstance(repeats, NoisyRepeats)
    run = repeats.runs[0]
    noisy = with_noise(run, repeats.noise, np.random.default_rng(1))
    for channel, deviation in repeats.noise.items():
        assert np.std(noisy[channel] - run[channel]) == pytest.approx(deviation, rel=0.3)
    assert np.array_equal(noisy["delta"], run["delta"])


@pytest.mark.parametrize(("old", "new", "sentence"), [
    ('"zigzag:20/20"', '"zigzg:20/20"', "zigzg"),
    ("v_j = 1.866", "v_jj = 1.866", "'v_jj' is no held input"),
    ("psi = {", "psy = {", "unknown channel 'psy'"),
    ('name = "waterjet"\n', 'name = "waterjt"\n', "unknown model 'waterjt'"),
    ("seeds = 4", 'seeds = 4\ntruth = "model.toml"', "give one of them"),
    ("seeds = 4", 'seeds = 4\nstart = { Y_vv = 0.1 }', "'Y_vv' is no free coefficient"),
    ("seeds = 4", "seeds = 2000000", "seeds = 2000000"),
])  # fmt: skip
def test_bad_plans_are_answered_with_one_sentence(tmp_path: Path, old: str, new: str, sentence: str) -> None:
    assert old in PLAN
    with pytest.raises(InputError) as caught:
        work_of_plan(plan(tmp_path, PLAN.replace(old, new)))
    assert sentence in str(caught.value)


def test_the_published_schema_is_current(repository: Path) -> None:
    published = json.loads((repository / "docs" / "campaign.schema.json").read_text(encoding="utf-8"))
    assert published == plan_schema(), "write docs/campaign.schema.json again: python docs/write_schemas.py"


def test_the_example_is_a_plan(repository: Path) -> None:
    example = work_of_plan(repository / "examples" / "coverage.toml")
    assert len(example.tasks()) == 200
