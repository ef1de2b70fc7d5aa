"""Published studies repeated: one explicit registry; importing this room imports no study."""

from typing import Protocol

from seatrial.results import Study
from seatrial.values import Progress


class Reproduction(Protocol):
    """Repeat a study; `quick` means fewer cases, under half a minute."""

    def __call__(self, *, quick: bool, seed: int, progress: Progress | None) -> Study: ...


def _alexandersson2022(*, quick: bool, seed: int, progress: Progress | None) -> Study:
    from seatrial.studies.alexandersson2022 import study

    return study(quick=quick, seed=seed, progress=progress)


def _section2d(*, quick: bool, seed: int, progress: Progress | None) -> Study:
    from seatrial.studies.section2d import study

    return study(quick=quick, seed=seed, progress=progress)


def _qi2025(*, quick: bool, seed: int, progress: Progress | None) -> Study:
    from seatrial.studies.qi2025 import study

    return study(quick=quick, seed=seed, progress=progress)


def _meng2014(*, quick: bool, seed: int, progress: Progress | None) -> Study:
    from seatrial.studies.meng2014 import study

    return study(quick=quick, seed=seed, progress=progress)


def _song2025(*, quick: bool, seed: int, progress: Progress | None) -> Study:
    from seatrial.studies.song2025 import study

    return study(quick=quick, seed=seed, progress=progress)


def _yu2014(*, quick: bool, seed: int, progress: Progress | None) -> Study:
    from seatrial.studies.yu2014 import study

    return study(quick=quick, seed=seed, progress=progress)


STUDIES: dict[str, Reproduction] = {
    "alexandersson2022": _alexandersson2022,
    "section2d": _section2d,
    "qi2025": _qi2025,
    "meng2014": _meng2014,
    "song2025": _song2025,
    "yu2014": _yu2014,
}

__all__ = ["STUDIES", "Reproduction"]
