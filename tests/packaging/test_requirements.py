"""The lowest versions are those of pyproject.toml, and whatever calls make calls targets that exist."""

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.version import Version


def test_each_lowest_version_is_the_bound_of_its_requirement(repository: Path) -> None:
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = {name: texts for name, texts in project["optional-dependencies"].items() if name != "dev"}
    requirements = {
        requirement.name: requirement
        for requirement in map(Requirement, sum(extras.values(), start=list(project["dependencies"])))
    }
    lines = (repository / "constraints-lowest.txt").read_text(encoding="utf-8").splitlines()
    pins = dict(line.split("==") for line in lines if not line.startswith("#"))
    assert sorted(pins) == sorted(requirements)
    for name, requirement in requirements.items():
        (bound,) = (Version(part.version) for part in requirement.specifier if part.operator == ">=")
        assert Version(pins[name]).release[: len(bound.release)] == bound.release, name


def test_workflow_and_hooks_call_targets_of_the_makefile(repository: Path) -> None:
    makefile = (repository / "Makefile").read_text(encoding="utf-8")
    targets = set(re.findall(r"^([a-z]+):", makefile, re.MULTILINE))
    for name in (".github/workflows/ci.yml", ".pre-commit-config.yaml", ".ci/run"):
        called = re.findall(r"^\s*(?:- run: |entry: )?make ([a-z]+)", (repository / name).read_text(), re.MULTILINE)
        assert called, name
        assert set(called) <= targets, name


def test_every_make_target_of_the_readme_exists(repository: Path) -> None:
    targets = set(re.findall(r"^([a-z]+):", (repository / "Makefile").read_text(encoding="utf-8"), re.MULTILINE))
    for page in ("README.md", "CONTRIBUTING.md"):
        called = re.findall(r"make ([a-z]+)\b", " ".join(re.findall(r"`make [^`]*`", (repository / page).read_text())))
        assert set(called) <= targets, page
