"""`[family]`: what it declares is kept; what no model has is refused with file and key."""

from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import ModelFamily, load_trial


def declared(trial_file: Path, table: str) -> Path:
    trial_file.write_text(f"{trial_file.read_text()}\n[family]\n{table}\n")
    return trial_file


def test_a_family_is_kept(trial_file: Path) -> None:
    table = 'structures = { inertia = ["m_x", "m_y"] }'
    assert load_trial(declared(trial_file, table)).family == ModelFamily({"inertia": ("m_x", "m_y")})


def test_without_a_table_the_family_of_the_package_counts(trial_file: Path) -> None:
    assert load_trial(trial_file).family is None


@pytest.mark.parametrize(
    ("table", "says"),
    [
        ('structures = { inertia = ["m_x", "m_yy"] }', "family.structures.'inertia': unknown name 'm_yy'"),
        ("structurs = {}", "family.structurs"),
        ("prior_factors = [3.0]", "which is no key any more; write priors under [model.priors]"),
    ],
)
def test_a_wrong_family_is_refused_with_file_and_key(trial_file: Path, table: str, says: str) -> None:
    with pytest.raises(InputError) as refused:
        load_trial(declared(trial_file, table))
    assert str(trial_file) in str(refused.value)
    assert says in str(refused.value)
    assert "\n" not in str(refused.value)
