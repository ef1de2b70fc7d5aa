"""Problems by name: those of the studies, and those that other packages install under ``seatrial.problems``."""

from collections.abc import Mapping
from fnmatch import fnmatchcase
from functools import cache

from seatrial._plugins import installed, load_plugin
from seatrial.core.values import InputError, spelling_hint
from seatrial.problems.problem import BenchmarkProblem

ENTRY_POINT_GROUP = "seatrial.problems"


def list_problems() -> tuple[BenchmarkProblem, ...]:
    """Return all installed problems, family after family; those whose records are absent are left out.

    Raises:
        InputError: an installed family cannot be loaded; the package is named.
    """
    absent = absent_families()
    names = (name for name in installed(ENTRY_POINT_GROUP) if name not in absent)
    return tuple(problem for name in names for problem in _family(name))


def absent_families() -> Mapping[str, str]:
    """Return the families whose records are not here, with the reason, what to do included.

    Raises:
        InputError: as `list_problems`.
    """
    reasons = {}
    for name in installed(ENTRY_POINT_GROUP):
        make = load_plugin(ENTRY_POINT_GROUP, name, InputError)
        try:
            make()
        except InputError as error:
            reasons[name] = str(error)
    return reasons


def problem_named(name: str) -> BenchmarkProblem:
    """Return the problem of a name.

    Raises:
        InputError: there is none; the nearest is named. Or its records are not here.
    """
    family = name.partition("-")[0]
    problems = _family(family) if family in installed(ENTRY_POINT_GROUP) else ()
    for problem in problems:
        if problem.name == name:
            return problem
    names = [p.name for p in problems or list_problems()]
    raise InputError(f"there is no problem '{name}'{spelling_hint(name, names)}")


def problems_matching(patterns: tuple[str, ...]) -> tuple[BenchmarkProblem, ...]:
    """Return the problems of names, families (``qi2025``) and patterns (``qi2025-*-whole``), each once.

    Raises:
        InputError: a pattern matches none, or the records of a family that is named are not here.
    """
    matching: dict[str, BenchmarkProblem] = {}
    for pattern in patterns:
        if pattern in installed(ENTRY_POINT_GROUP):
            problems = _family(pattern)
        elif any(sign in pattern for sign in "*?["):
            problems = tuple(p for p in list_problems() if fnmatchcase(p.name, pattern))
        else:
            problems = (problem_named(pattern),)
        if not problems:
            raise InputError(f"no problem matches '{pattern}'; 'seatrial benchmark --list' names them")
        matching |= {p.name: p for p in problems}
    return tuple(matching.values())


@cache
def _family(name: str) -> tuple[BenchmarkProblem, ...]:
    """The problems of one entry point, a function without arguments; it raises InputError where records are absent."""
    return tuple(load_plugin(ENTRY_POINT_GROUP, name, InputError)())
