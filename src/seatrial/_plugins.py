"""Objects that other packages install under an entry-point group: models, readers, estimators, optimisers, studies."""

from importlib.metadata import EntryPoint, entry_points
from typing import Any


def installed(group: str) -> dict[str, EntryPoint]:
    """Return the entry points of a group by name, in alphabetical order; nothing is loaded."""
    return {point.name: point for point in sorted(entry_points(group=group), key=lambda point: point.name)}


def load_plugin(group: str, name: str, refusal: type[ValueError]) -> Any:
    """Load the object that an installed package offers under a name.

    Raises:
        refusal: its module is missing, fails when it is imported, or lacks the object; the package is named.
    """
    point = installed(group)[name]
    try:
        return point.load()
    except Exception as error:
        raise refusal(failure_text(point, error)) from error


def failure_text(point: EntryPoint, error: Exception) -> str:
    """Return the sentence for an installed object that failed."""
    package = point.dist.name if point.dist is not None else "an unknown package"
    reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
    return f"'{point.name}' ({point.value}, installed by {package}) fails: {reason}; update or uninstall the package"
