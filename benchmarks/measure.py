"""How a benchmark measures and what it reports."""

import os
import platform
import time
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Line:
    """One line of the table: what, how much, and the target it is held against, where there is one."""

    quantity: str
    value: float
    unit: str
    target: str = ""
    holds: bool | None = None

    @property
    def verdict(self) -> str:
        """In words."""
        return "" if self.holds is None else f"target {self.target} {'holds' if self.holds else 'missed'}"


def at_least(quantity: str, value: float, unit: str, limit: float) -> Line:
    """A line whose value should not fall below `limit`."""
    return Line(quantity, value, unit, f">= {limit:g} {unit}", value >= limit)


def at_most(quantity: str, value: float, unit: str, limit: float) -> Line:
    """A line whose value should not exceed `limit`."""
    return Line(quantity, value, unit, f"<= {limit:g} {unit}", value <= limit)


def fastest(function: Callable[[], object], repeats: int = 9) -> float:
    """Shortest of several runs [s], after one that does not count: what the machine can do undisturbed."""
    function()
    times = []
    for _ in range(repeats):
        began = time.perf_counter()
        function()
        times.append(time.perf_counter() - began)
    return min(times)


def machine() -> str:
    """CPU model, cores, operating system and Python of this machine."""
    model = platform.processor() or platform.machine()
    table = Path("/proc/cpuinfo")
    if table.exists():
        names = [
            line.split(":", 1)[1].strip() for line in table.read_text().splitlines() if line.startswith("model name")
        ]
        model = names[0] if names else model
    return f"{model}, {os.cpu_count()} cores, {platform.system()}, Python {platform.python_version()}"
