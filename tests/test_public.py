"""`import seatrial as st`: its names, what importing it costs, and what a type checker sees of it."""

import ast
import json
import subprocess
import sys
from pathlib import Path
from types import ModuleType

import pytest

import seatrial as st

LONGEST_IMPORT = 0.05  # s of processor time on top of a bare interpreter, the limit set for this package
SCRIPT = """
from pathlib import Path

import numpy as np

import seatrial as st

trial = st.load_trial("examples/waterjet.toml")
findings = [finding.text for finding in st.check(trial)]
fit = st.identify(trial, seed=1, report_progress=print)
model: st.Model = st.models.mmg()
parameters: st.Parameters = model.parameters.fixed("m_x_prime").bounded("Y_v", -1.0, 0.0)
record = st.simulate(model.with_parameters(parameters), "zigzag:20/20", inputs={"n": 10.0})
page: Path = st.report(fit, "report.html")
largest = float(np.max(record["psi"]))
st.testing.check_model(model)
sheet = st.Sheet("yaw", source="a paper")
(r,) = sheet.states("r")
box = st.optimisers.Box(np.zeros(2), np.ones(2))
raise st.InputError("the end")
"""
MISTAKES = """
import seatrial as st

st.identify(20)
st.simulate(st.models.mmg(), manoeuvre=20)
st.estimate
st.models.kvlcc
"""


def test_the_docstring_lists_every_name() -> None:
    contents = st.__doc__ or ""
    assert [name for name in st.__all__ if name not in contents] == []
    assert 40 <= len(st.__all__) <= 57


def test_dir_and_all_agree_with_what_can_be_got() -> None:
    assert set(st.__all__) <= set(dir(st))
    assert all(getattr(st, name) is not None for name in st.__all__)
    with pytest.raises(AttributeError, match="no attribute 'estimate'"):
        _ = st.estimate  # type: ignore[attr-defined]


def test_modules_hide_no_function() -> None:
    """A module of the same name, imported first, would take the place of the function in its package."""
    from seatrial.physics.models.mmg import mmg

    assert st.models.mmg is mmg
    assert st.models.roll().states == ("phi", "p")
    assert isinstance(st.control, ModuleType)
    assert not any(isinstance(one, ModuleType) for one in (st.design, st.report, st.simulate, st.follow))


def test_importing_costs_little_and_loads_nothing_heavy() -> None:
    program = (
        "import json, sys, time; start = time.process_time(); import seatrial; names = dir(seatrial); "
        "spent = time.process_time() - start; heavy = ('numpy', 'scipy', 'sympy', 'numba', 'pandas', 'matplotlib'); "
        "print(json.dumps([spent, [name for name in heavy if name in sys.modules]]))"
    )
    runs = [
        json.loads(subprocess.run([sys.executable, "-c", program], capture_output=True, check=True).stdout)
        for _ in range(3)
    ]
    assert min(spent for spent, _ in runs) < LONGEST_IMPORT
    assert runs[0][1] == []


@pytest.mark.parametrize("stub", sorted((Path(st.__file__).parent).rglob("__init__.pyi")), ids=lambda p: p.parent.name)
def test_the_list_of_a_stub_names_what_it_imports(stub: Path) -> None:
    tree = ast.parse(stub.read_text(encoding="utf-8"))
    names = [alias for node in tree.body if isinstance(node, ast.ImportFrom) for alias in node.names]
    lists = [ast.literal_eval(node.value) for node in tree.body if isinstance(node, ast.Assign)]
    reexported = lists[0] if lists else [alias.name for alias in names if alias.asname == alias.name]
    assert sorted(alias.asname or alias.name for alias in names) == sorted(reexported)


def type_errors(folder: Path, script: str) -> list[str]:
    """The complaints of basedpyright about a user's script, one rule each."""
    pytest.importorskip("basedpyright", reason="needs the extra 'dev'")
    (folder / "script.py").write_text(script, encoding="utf-8")
    (folder / "pyrightconfig.json").write_text(
        json.dumps({"typeCheckingMode": "standard", "extraPaths": [str(Path(st.__file__).parents[1])]})
    )
    command = [sys.executable, "-m", "basedpyright", "--outputjson", "--pythonpath", sys.executable, "script.py"]
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    return [entry["message"] for entry in json.loads(run.stdout)["generalDiagnostics"] if entry["severity"] == "error"]


def test_a_users_script_type_checks(tmp_path: Path) -> None:
    assert type_errors(tmp_path, SCRIPT) == []


def test_a_users_mistakes_are_seen(tmp_path: Path) -> None:
    errors = " ".join(type_errors(tmp_path, MISTAKES))
    for word in ('"Trial | str | Path"', '"str | Record"', '"estimate"', '"kvlcc"'):
        assert word in errors
