"""Results, models, trials and loops of the first version load, or are refused with what to do."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from tests.data.folder.write_earlier_results import FOLDER, RESULTS

import seatrial as st
from seatrial.api import campaign_status, gather_campaign
from seatrial.data.folder.gains_file import read_gains

FILES = Path(__file__).with_name("earlier_files")
LOOPS = {
    "fin_from_decay": "roll", "fin_stabiliser": "", "ride_control": "heave_pitch", "waterjet_autopilot": "waterjet",
    "waterjet_track": "waterjet", "waterjet_weather": "waterjet",
}  # fmt: skip
TRIALS = sorted(path.stem for path in FILES.glob("*.toml") if path.stem not in {*LOOPS, "gains"})


@pytest.mark.parametrize("name", RESULTS)
def test_a_result_loads(name: str) -> None:
    result = st.load(FOLDER / name)
    assert type(result).__name__.lower() == name


def test_the_numbers_of_a_fit_are_those_that_were_written() -> None:
    fit = st.load_fit(FOLDER / "fit")
    assert len(fit.params) == 11 and len(fit.records) == 4
    assert fit.params["Y_v"] == pytest.approx(fit.model.parameters["Y_v"].value, rel=1e-12)
    assert fit.covariance.shape == (11, 11) and np.isfinite(fit.predictions[0].simulated["psi"]).all()
    assert "zigzag_25_25" in [p.record for p in fit.validation]


@pytest.mark.parametrize("path", sorted((FILES / "models").glob("*.toml")), ids=lambda p: p.stem)
def test_a_model_file_loads(path: Path) -> None:
    file = st.load_model(path)
    assert len(file.covariance) == len(file.model.parameters.free)
    assert [source.role for source in file.provenance.records].count("training") >= 1


@pytest.mark.parametrize("name", TRIALS)
def test_a_trial_file_loads(name: str, tmp_path: Path, repository: Path, request: pytest.FixtureRequest) -> None:
    text = (FILES / f"{name}.toml").read_text(encoding="utf-8")
    if "${SEATRIAL_DATA}" in text:
        text = text.replace("${SEATRIAL_DATA}", request.getfixturevalue("data_folder").as_posix())
    (tmp_path / "trial.toml").write_text(text, encoding="utf-8")
    for folder in (repository / "examples").iterdir():
        if folder.is_dir() and f'folder = "{folder.name}"' in text:
            shutil.copytree(folder, tmp_path / folder.name)
    trial = st.load_trial(tmp_path / "trial.toml")
    assert trial.model.states


@pytest.mark.parametrize("name", LOOPS)
def test_a_loop_file_loads(name: str) -> None:
    model = FILES / "models" / f"{LOOPS[name]}.toml" if LOOPS[name] else None
    task = st.load_loop(FILES / f"{name}.toml", model_file=model)
    assert len(task.objectives) > 1


def test_a_file_of_gains_loads() -> None:
    gains = read_gains(FILES / "gains.toml")
    assert gains and all(np.isfinite(list(gains.values())))


def test_a_campaign_loads() -> None:
    assert campaign_status(FILES / "campaign").done == 1
    assert len(gather_campaign(FILES / "campaign").coefficients) == 11
