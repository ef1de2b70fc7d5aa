"""The command for reports of faults: what is installed, where the cache lies, and whether a known craft is found."""

import re
import sys
import time
from collections.abc import Iterator

from seatrial.cli.application import app
from seatrial.cli.screen import print_heading, print_table

_EXTRA = re.compile(r"""^(?P<package>[\w.-]+)[^;]*;.*extra == ['"](?P<extra>\w+)['"]""")
_DEVELOPMENT = ("all", "dev")  # extras of which nothing is missing for a user
# 1/s, s, m/s, m and s: the craft that the check simulates, and for how long; how far an estimate may be off; chosen
_GAIN, _TIME_CONSTANT_S, _SPEED, _LENGTH, _DURATION_S, _LIMIT = 0.15, 8.0, 2.0, 8.0, 60.0, 0.01


@app.command()
def doctor() -> None:
    """Say what a report of a fault needs: versions, compile cache, cores, extras, and a check of a few seconds.

    Example: seatrial doctor
    """
    print_heading("Versions")
    print_table(list(_versions()), flush_left=(0, 1))
    print_heading("Machine")
    print_table(list(_machine()), flush_left=(0, 1))
    print_heading("Extras")
    print_table([[name, missing] for name, missing in _extras()], flush_left=(0, 1))
    began = time.perf_counter()
    is_right, text = _check()
    print_heading("Check")
    print_table([[text, f"{time.perf_counter() - began:.1f} s"]], flush_left=(0, 1))
    if not is_right:
        raise RuntimeError(text)


def _versions() -> Iterator[list[str]]:
    from seatrial.core.values.versions import versions

    for name, version in versions().items():
        yield [name, version]


def _machine() -> Iterator[list[str]]:
    import platform

    from seatrial.numerics.kernels.cache import cache_folder
    from seatrial.numerics.platform import usable_cores

    folder = cache_folder()
    entries = [path.stat().st_size for path in folder.iterdir() if path.is_file()]
    yield ["system", f"{platform.system()} {platform.release()}, {platform.machine()}"]
    yield ["cores", f"{usable_cores()}"]
    yield ["compile cache", f"{folder}: {len(entries)} entries, {sum(entries)} bytes"]
    yield ["terminal", f"standard output in {sys.stdout.encoding}"]


def _extras() -> Iterator[tuple[str, str]]:
    """Yield each extra with the packages that it lacks."""
    from importlib.metadata import PackageNotFoundError, requires, version

    lacking: dict[str, list[str]] = {}
    for requirement in filter(None, map(_EXTRA.match, requires("seatrial") or ())):
        if requirement["extra"] in _DEVELOPMENT:
            continue
        packages = lacking.setdefault(requirement["extra"], [])
        try:
            version(requirement["package"])
        except PackageNotFoundError:
            packages.append(requirement["package"])
    for name, packages in sorted(lacking.items()):
        yield name, f"lacks {', '.join(packages)}: pip install 'seatrial[{name}]'" if packages else "installed"


def _check() -> tuple[bool, str]:
    """Simulate a craft, identify it from its zigzag, and compare: whether it is found, and a sentence."""
    import seatrial as st

    craft = st.models.nomoto().with_values({"K": _GAIN, "T": _TIME_CONSTANT_S, "U": _SPEED})
    zigzag = st.simulate(craft, "zigzag:20/20", duration=_DURATION_S)
    fit = st.identify(st.Trial(st.Ship("craft", {"L": _LENGTH}), (st.Run(zigzag),), st.models.nomoto()))
    gain, time_constant = fit["K"].estimate, fit["T"].estimate
    is_right = max(abs(gain / _GAIN - 1.0), abs(time_constant / _TIME_CONSTANT_S - 1.0)) < _LIMIT
    found = f"K {gain:.4f} 1/s, T {time_constant:.3f} s from a simulated zigzag of K {_GAIN:g}, T {_TIME_CONSTANT_S:g}"
    return is_right, found if is_right else f"{found}: wrong, so that no result of this machine should be used"
