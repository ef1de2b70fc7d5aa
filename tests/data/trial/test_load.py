"""What a trial file says is kept; what it says wrongly is refused in one sentence."""

import math
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError, Prior
from seatrial.data.trial import Role, load_trial


def changed(trial_file: Path, old: str, new: str) -> Path:
    text = trial_file.read_text()
    assert old in text
    trial_file.write_text(text.replace(old, new, 1))
    return trial_file


def test_runs_have_their_roles_and_sessions(trial_file: Path) -> None:
    trial = load_trial(trial_file)
    assert [(r.name, r.role, r.session) for r in trial.runs] == [
        ("a_2024-05-01", Role.TRAIN, "2024-05-01"),
        ("b_2024-05-02", Role.TRAIN, "2024-05-02"),
        ("c_2024-05-02", Role.VALIDATE, "2024-05-02"),
    ]


def test_train_patterns_leave_out_the_rest(trial_file: Path) -> None:
    trial = load_trial(changed(trial_file, 'validate = "c_*"', 'train = "a_*"\nvalidate = "c_*"'))
    assert [r.role for r in trial.runs] == [Role.TRAIN, Role.LEAVE_OUT, Role.VALIDATE]


@pytest.mark.parametrize(("rule", "sessions"), [("run", 3), ("day", 2), ("*_{month}-??", 1), ("{letter}_*", 3)])
def test_sessions_follow_the_rule(trial_file: Path, rule: str, sessions: int) -> None:
    trial = load_trial(changed(trial_file, 'session = "day"', f"session = '{rule}'"))
    assert len({r.session for r in trial.runs}) == sessions


def test_units_of_particulars_are_converted(trial_file: Path) -> None:
    trial = load_trial(changed(trial_file, "L = 9.8", 'L = { value = 980, unit = "cm" }'))
    assert trial.ship.length == pytest.approx(9.8)
    assert trial.model.parameters["L"].value == pytest.approx(9.8)


def test_model_choices_are_applied(trial_file: Path) -> None:
    choices = """[model]
free = ["Y_v", "N_v"]
start = { Y_v = -0.2 }
fixed = { Y_r = 0.1 }
bounds = { Y_v = [-1.0, inf] }
priors = { N_v = { mean = -0.1, sd = 0.02, source = "guess" } }
prior_sd_percent = 10
"""
    parameters = load_trial(changed(trial_file, "[model]\n", choices)).model.parameters
    assert parameters.free_names == ("Y_v", "N_v")
    assert (parameters["Y_v"].value, parameters["Y_r"].value) == (-0.2, 0.1)
    assert (parameters["Y_v"].lower, parameters["Y_v"].upper) == (-1.0, math.inf)
    assert parameters["N_v"].prior == Prior(-0.1, 0.02, "guess")
    prior = parameters["Y_v"].prior
    assert prior is not None
    assert (prior.mean, prior.standard_deviation) == (-0.2, pytest.approx(0.02))


@pytest.mark.parametrize(("key", "name"), [("offsets", "psi"), ("offsets", "zeta"), ("gains", "r")])
def test_only_inputs_have_corrections(trial_file: Path, key: str, name: str) -> None:
    wrong = changed(trial_file, "[model]\n", f'[estimate]\n{key} = ["{name}"]\n\n[model]\n')
    with pytest.raises(InputError, match=rf"estimate\.{key}: unknown name '{name}'; inputs .* in channels\.{name}"):
        load_trial(wrong)


def test_estimate_settings_are_in_si(trial_file: Path) -> None:
    extra = """[noise]
psi = { sd = 0.2, unit = "deg" }
u = 0.02

[estimate]
offsets = { delta = { sd = 1, unit = "deg" } }
gains = ["v_j"]

[model]
"""
    trial = load_trial(changed(trial_file, "[model]\n", extra))
    assert trial.noise == {"psi": pytest.approx(np.radians(0.2)), "u": 0.02}
    assert trial.estimate.offsets == {"delta": pytest.approx(np.radians(1.0))}
    assert trial.estimate.gains == {"v_j": None}


def test_environment_variables_name_the_folder(
    trial_file: Path, tmp_path_factory: pytest.TempPathFactory, monkeypatch: pytest.MonkeyPatch
) -> None:
    elsewhere = tmp_path_factory.mktemp("elsewhere") / "moved.toml"
    text = trial_file.read_text().replace("[ship]", '[data]\nfolder = "${SEATRIAL_TEST}/"\n[ship]')
    elsewhere.write_text(text)
    monkeypatch.setenv("SEATRIAL_TEST", str(trial_file.parent))
    assert len(load_trial(elsewhere).runs) == 3
    monkeypatch.chdir(trial_file.parent.parent)
    monkeypatch.setenv("SEATRIAL_TEST", trial_file.parent.name)
    assert len(load_trial(elsewhere).runs) == 3


REFUSALS = [
    ("unknown key", 'validate = "c_*"', 'validat = "c_*"', r"unknown key 'records\[1\].validat'.*'validate'"),
    ("unknown table", "[model]", "[modell]", "unknown key 'modell'.*'model'"),
    ("key of a channel", 'column = "surge"', 'colum = "surge"', r"records\[1\].channels.u.colum'.*'column'"),
    ("unknown particular", "L = 9.8", "L = 9.8\nLpp = 9.8", "unknown key 'ship.Lpp'"),
    ("no length", "L = 9.8", "", "key 'ship.L' is missing"),
    ("missing key", 'name = "craft"', "", "'ship.name' is missing"),
    (
        "one column for two",
        "u = { column",
        'v = { column = "surge", unit = "kn" }\nu = { column',
        "column 'surge' is named for",
    ),
    ("unknown unit", '"kn"', '"knots"', r"channels.u.unit: unknown unit 'knots'"),
    ("unit of another kind", '"kn"', '"deg"', "'deg' is no unit of surge velocity"),
    ("unknown channel", "u = { column", "uu = { column", "unknown channel 'uu'"),
    ("unknown direction", '"port"', '"left"', "positive = 'left'"),
    ("unknown format", "header_lines", 'format = "txt"\nheader_lines', "unknown format 'txt'; did you mean 'text'"),
    ("no match", '"*.csv"', '"*.dat"', "matches no file"),
    ("no pattern", '"*.csv"', '"a**b/*.csv"', "is no pattern"),
    ("no such file", '"*.csv"', '"z.csv"', "there is no file"),
    ("unset variable", '"*.csv"', '"${SEATRIAL_NOWHERE}/*.csv"', "SEATRIAL_NOWHERE .* is not set"),
    ("run to validate", '"c_*"', '"d_*"', r"validate: no run is called 'd_\*'"),
    ("two roles", 'validate = "c_*"', 'validate = "c_*"\ntrain = "*"', "named under both"),
    ("nothing to train", '"c_*"', '"*"', "no run is left to train on"),
    ("unknown model", '"waterjet"', '"waterjett"', "unknown model 'waterjett'.*'waterjet'"),
    ("unknown fixed", "[model]", "[model]\nfixed = { Y_vx = 1 }", "model.fixed: unknown parameter 'Y_vx'"),
    ("unknown free", "[model]", '[model]\nfree = ["Y_vx"]', "model.free: unknown parameter 'Y_vx'"),
    ("unknown prior", "[model]", "[model]\npriors = { Q = { sd = 1 } }", "model.priors: unknown parameter 'Q'"),
    ("bounds crossed", "[model]", "[model]\nbounds = { Y_v = [1, -1] }", "lower bound 1 is not below upper bound -1"),
    ("start outside", "[model]", "[model]\nbounds = { Y_v = [0, 1] }", "outside its bounds 0 to 1"),
    ("free and fixed", "[model]", '[model]\nfree = ["Y_v"]\nfixed = { Y_v = 1 }', "under both 'free' and 'fixed'"),
    ("an expression", '"day"', '"(a+)+$"', r"'\(a\+\)\+\$' is no template; give one such as '\*_{day}_\*'"),
    ("no session", '"day"', '"x{day}"', "'x{day}' does not fit the file name"),
    ("not a number", "L = 9.8", "L = nan", "finite number"),
    ("negative size", "L = 9.8", "L = 9.8\nm = -300", "ship.m = -300: a size is never negative"),
    (
        "time as length",
        "L = 9.8",
        'L = { value = 9.8, unit = "s" }',
        "ship.L: 's' is no unit of this particular; write one of m",
    ),
    ("no TOML", "[ship]", "[ship", "no valid TOML"),
    ("no size", "L = 9.8", 'L = { value = 1e308, unit = "km" }', "ship.L.value = 1e.308 is no size"),
    ("a long name", '"*.csv"', f'"{"x" * 300}.csv"', "there is no file"),
    ("left key", "[records.channels]", "from_s = 9\n[records.channels]", "no key any more; cut the run: parts = "),
]


@pytest.mark.parametrize(("old", "new", "says"), [r[1:] for r in REFUSALS], ids=[r[0] for r in REFUSALS])
def test_what_is_wrong_is_said_in_one_sentence(trial_file: Path, old: str, new: str, says: str) -> None:
    with pytest.raises(InputError, match=says) as raised:
        load_trial(changed(trial_file, old, new))
    assert str(trial_file) in str(raised.value)
    assert "\n" not in str(raised.value)
    assert "pydantic" not in str(raised.value).lower()


def test_a_missing_trial_file_is_named(tmp_path: Path) -> None:
    with pytest.raises(InputError, match=r"absent\.toml' cannot be read"):
        load_trial(tmp_path / "absent.toml")


def test_dots_in_a_file_name_belong_to_the_run(trial_file: Path) -> None:
    (trial_file.parent / "a_2024-05-01.csv").rename(trial_file.parent / "a_2.5deg_2024-05-01.csv")
    assert load_trial(trial_file).runs[0].name == "a_2.5deg_2024-05-01"


@pytest.mark.parametrize("key", ["k_xx", "k_xx_prime", "B"])
def test_what_gives_the_metacentric_height_is_a_particular(tmp_path: Path, key: str) -> None:
    path = tmp_path / "trial.toml"
    path.write_text(
        f'[ship]\nname = "ship"\nL = 24.0\n{key} = 2.1\n[model]\nname = "roll"\n[[records]]\nfiles = ["run.csv"]\n'
        'time = { column = "t" }\nchannels.phi = { column = "roll", unit = "deg" }\n',
        encoding="utf-8",
    )
    (tmp_path / "run.csv").write_text("t,roll\n0,1\n1,2\n", encoding="utf-8")
    assert load_trial(path).ship.particulars[key] == 2.1
