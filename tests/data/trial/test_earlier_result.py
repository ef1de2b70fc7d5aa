"""Priors from the folder of an earlier result, named in the trial file."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import seatrial as st
from seatrial.core.values import frozen
from seatrial.data.folder.model_file import ModelFile, ModelProvenance, RecordSource, write_model
from seatrial.data.read.record_file import file_digest

Writer = Callable[..., None]


@pytest.fixture
def monday(trial_folder: Path) -> Writer:
    """Writes the model file of an earlier fit, and names it in the trial file."""

    def write(model: st.Model, used: str = "") -> None:
        folder = trial_folder / "monday"
        folder.mkdir()
        free = model.parameters.free
        covariance = np.diag([(0.1 * p.value) ** 2 for p in free])
        source = RecordSource(used, "training", file_digest(trial_folder / used) if used else "")
        write_model(
            ModelFile(model, frozen(covariance), ModelProvenance((source,))), trial_folder / "monday/model.toml"
        )
        with (trial_folder / "trial.toml").open("a") as file:
            file.write('priors_from = "monday/"\n')

    return write


def test_the_earlier_fit_gives_means_starts_and_deviations(monday: Writer, trial_file: Path) -> None:
    model = st.models.waterjet()
    monday(model.with_values({"N_r": 1.2 * model.parameters["N_r"].value}))
    (p, other) = (st.load_trial(trial_file).model.parameters[n] for n in ("N_r", "Y_v"))
    assert p.prior is not None and other.prior is not None
    assert p.value == p.prior.mean == pytest.approx(1.2 * model.parameters["N_r"].value)
    assert p.prior.standard_deviation == pytest.approx(0.1 * abs(p.value) * np.sqrt(1.01))
    assert "monday" in other.prior.source


def test_records_behind_the_priors_are_refused(monday: Writer, trial_file: Path) -> None:
    monday(st.models.waterjet(), used="a_2024-05-01.csv")
    with pytest.raises(st.InputError, match="'a_2024-05-01' was already used for 'monday/'"):
        st.load_trial(trial_file)


def test_a_fit_of_another_model_is_refused(monday: Writer, trial_file: Path) -> None:
    monday(st.models.nomoto())
    with pytest.raises(st.InputError, match="'monday/' is a fit of model 'nomoto', not of 'waterjet'"):
        st.load_trial(trial_file)


def test_a_folder_without_a_result_is_refused(trial_file: Path) -> None:
    trial_file.write_text(trial_file.read_text() + 'priors_from = "nowhere/"\n')
    with pytest.raises(st.InputError, match="'nowhere/' is no result of identify"):
        st.load_trial(trial_file)
