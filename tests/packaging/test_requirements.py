"""The lowest versions are those of pyproject.toml, and whatever calls make calls targets that exist."""

import re
import tomllib
from pathlib import Path

from packaging.requirements import Requirement
from packaging.version import Version

import seatrial


def test_each_lowest_version_is_the_bound_of_its_requirement(repository: Path) -> None:
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    extras = {name: texts for name, texts in project["optional-dependencies"].items() if name not in ("all", "dev")}
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


def test_all_names_every_extra_but_that_of_developers(repository: Path) -> None:
    extras = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"][
        "optional-dependencies"
    ]
    (everything,) = map(Requirement, extras["all"])
    assert everything.name == "seatrial" and everything.extras == set(extras) - {"all", "dev"}


def test_version_citation_and_recipe_agree(repository: Path) -> None:
    version = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]["version"]
    assert seatrial.__version__ == version
    for name, line in (
        ("CITATION.cff", f"version: {version}"),
        ("distribution/conda/recipe.yaml", f'version: "{version}"'),
    ):
        assert line in (repository / name).read_text(encoding="utf-8"), name
    assert f"## {version}" in (repository / "CHANGELOG.md").read_text(encoding="utf-8")


def test_the_recipe_needs_what_the_wheel_needs(repository: Path) -> None:
    project = tomllib.loads((repository / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    run = (repository / "distribution" / "conda" / "recipe.yaml").read_text(encoding="utf-8").partition("  run:\n")[2]
    for requirement in map(Requirement, project["dependencies"]):
        name = {"matplotlib": "matplotlib-base"}.get(requirement.name, requirement.name)
        assert f"    - {name} {requirement.specifier}\n" in run


def test_the_script_takes_the_steps_of_the_dockerfile(repository: Path) -> None:
    folder = repository / "distribution"
    steps = [(folder / name).read_text(encoding="utf-8") for name in ("Dockerfile", "container.sh")]
    for words in ("pip", "--no-deps", "[app,formats,logs]", "constraints.txt", "700", "SEATRIAL_CACHE", "doctor"):
        assert all(words in step for step in steps), words
    assert "USER trial" in steps[0] and "VOLUME /cache" in steps[0]
