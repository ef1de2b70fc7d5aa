"""What is exported is written whole or not at all."""

from pathlib import Path

import pytest

import seatrial as st
from seatrial.api import export_targets
from seatrial.core.values import InputError
from seatrial.data.folder.model_file import ModelFile, write_model
from seatrial.physics.models.published import kvlcc2


def test_a_model_file_is_exported_by_its_path(tmp_path: Path) -> None:
    write_model(ModelFile(kvlcc2()), tmp_path / "model.toml")
    result = st.export(tmp_path / "model.toml", "c99", tmp_path / "new" / "ship")
    assert sorted(result.files) == sorted(p.name for p in (tmp_path / "new" / "ship").iterdir())
    assert export_targets(tmp_path / "model.toml")["c99"] == ""


def test_a_model_without_all_values_is_refused(tmp_path: Path) -> None:
    with pytest.raises(InputError, match="no value for L, d"):
        st.export(st.models.mmg(), "c99", tmp_path / "ship")
    assert list(tmp_path.iterdir()) == []


def test_a_path_that_exists_is_refused(tmp_path: Path) -> None:
    (tmp_path / "ship").mkdir()
    with pytest.raises(InputError, match="ship' exists; choose another place"):
        st.export(kvlcc2(), "c99", tmp_path / "ship")
    with pytest.raises(InputError, match="a folder, without a suffix"):
        st.export(kvlcc2(), "c99", tmp_path / "ship.c")
    assert list((tmp_path / "ship").iterdir()) == []


def test_a_result_folder_stands_for_its_model(tmp_path: Path) -> None:
    write_model(ModelFile(kvlcc2()), tmp_path / "model.toml")
    assert sorted(st.export(tmp_path, "c99", tmp_path / "ship").files) == ["ship.c", "ship.h"]


def test_a_folder_of_gains_is_refused_with_what_to_give(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"holds no model\.toml; give the folder that 'seatrial identify' wrote"):
        st.export(tmp_path, "ardupilot", tmp_path / "boat.param")
    (tmp_path / "gains.toml").write_text("[gains]\nKP = 1.0\n")
    with pytest.raises(InputError, match="holds gains and no model; give the model file they were tuned on"):
        st.export(tmp_path, "ardupilot", tmp_path / "boat.param")


@pytest.mark.parametrize(("name", "example"), [("7ship", "ship_7ship"), ("while", "ship_while"), ("a b", "a_b")])
def test_a_name_that_is_no_identifier_is_refused_with_one_that_is(name: str, example: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"such as '{example}'"):
        st.export(kvlcc2(), "c99", tmp_path / name)
    assert list(tmp_path.iterdir()) == []
