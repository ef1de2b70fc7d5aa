"""Studies import names that a documented subpackage of seatrial offers, never from a module inside one."""

import ast
import importlib
import re
from pathlib import Path

import pytest

import seatrial_studies

ROOT = Path(__file__).parents[2]
STUDIES = Path(seatrial_studies.__path__[0])
# the table of docs/architecture.md: | `physics.sea` | what it offers | ..., a layer without subpackages by its own name
TABLE = re.findall(r"^\| `([a-z_]+(?:\.[a-z_]+)?)` \|", (ROOT / "docs" / "architecture.md").read_text(), re.MULTILINE)
DOCUMENTED = [name for name in TABLE if hasattr(importlib.import_module(f"seatrial.{name}"), "__all__")]


def _imports(path: Path) -> list[tuple[str, str]]:
    """Module and name of each import from seatrial."""
    found = []
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and node.module and node.module.split(".")[0] == "seatrial":
            found += [(node.module, alias.name) for alias in node.names]
        elif isinstance(node, ast.Import):
            found += [(alias.name, "") for alias in node.names if alias.name.split(".")[0] == "seatrial"]
    return found


@pytest.mark.parametrize("path", sorted(STUDIES.rglob("*.py")), ids=lambda path: str(path.relative_to(STUDIES)))
def test_a_study_imports_documented_names_only(path: Path) -> None:
    for module, name in _imports(path):
        assert module.removeprefix("seatrial.") in DOCUMENTED, f"{path.name} imports from {module}"
        assert name in importlib.import_module(module).__all__, f"{module} does not offer {name}"


@pytest.mark.parametrize("subpackage", DOCUMENTED)
def test_a_documented_subpackage_offers_what_it_lists(subpackage: str) -> None:
    package = importlib.import_module(f"seatrial.{subpackage}")
    assert package.__all__
    for name in package.__all__:
        assert not isinstance(getattr(package, name), type(importlib)), f"{subpackage}.{name} is a module"
