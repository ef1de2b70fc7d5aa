"""Compare every number of the results of six examples with those of another revision, to the bit.

`python benchmarks/compare_versions.py REVISION` checks the revision out into a temporary folder, runs both versions on
the same examples (records of real ships in SEATRIAL_DATA) and lists each number that differs. Times, formats and
versions of packages are left out; keys that were renamed since are looked up under their old names.
"""

import json
import math
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Mapping
from pathlib import Path

REPOSITORY = Path(__file__).parents[1]
EXAMPLES = {
    "waterjet": "identify", "kvlcc2_hsva": "identify", "esso_osaka": "identify", "heave_pitch": "identify",
    "fin_decay": "identify", "fin_stabiliser": "tune",
}  # fmt: skip
NOT_COMPARED = {"elapsed_s", "format", "versions"}
RENAMED = {
    "Ms": "peak", "baseline": "other", "baseline_costs": "others", "baselines": "rivals", "candidate_models": "family",
    "conditions": "at", "constraints": "restriction", "converged_runs": "converged", "degrees_of_freedom": "freedom",
    "distance": "room", "estimate_changes": "moves", "extended_fronts": "richer", "free_count": "free",
    "gain_names": "names", "gyradius_source": "assumed", "is_chosen": "chosen", "is_identified": "told",
    "is_significant": "is_told", "is_tied": "tied", "last_problem": "last", "most_changed": "most",
    "noise_floor": "floor", "noise_model": "noise", "normalised_difference": "gap", "paired_differences": "paired",
    "relative_error": "relative", "relative_spread": "spread", "rms_acceleration": "acceleration", "roll": "rolling",
    "sampled_distance": "drawn_room", "sampled_drift": "drawn_drift", "sampled_relative_error": "drawn",
    "saturation_loss": "lost", "sea_room": "room", "seaway_simulations": "sailed", "sickness_incidence": "sickness",
    "significant_amplitude": "significant", "stage": "what", "tied_spread": "spread", "violated": "broken",
    "worst_sampled_error": "worst_drawn", "zero_crossing_periods": "periods",
}  # fmt: skip
"""Key of the JSON today -> its name in version 0.1."""
MOVED = {".extrapolation.index": ".extrapolation_index", ".extrapolation.ratios.": ".extrapolation."}
"""Part of a place today -> the place in version 0.1."""


def numbers(value: object, place: str = "") -> Iterator[tuple[str, object]]:
    """Yield every leaf of a JSON document with its place, keys under their old names."""
    if isinstance(value, Mapping):
        for key, inner in value.items():
            if key not in NOT_COMPARED:
                yield from numbers(inner, f"{place}.{RENAMED.get(key, key)}")
    elif isinstance(value, list):
        for index, inner in enumerate(value):
            yield from numbers(inner, f"{place}[{index}]")
    elif isinstance(value, int | float) or value is None:
        for part, earlier in MOVED.items():
            place = place.replace(part, earlier)
        yield place, value


def run(source: Path, example: str, command: str, folder: Path) -> dict[str, object]:
    """Return the JSON that a checkout writes for one example."""
    document = folder / f"{example}.json"
    program = "from seatrial.cli import main; main()"
    arguments = [command, f"examples/{example}.toml", "--out", str(folder / example), "--json", str(document)]
    environment = {**os.environ, "PYTHONPATH": str(source / "src")}
    subprocess.run([sys.executable, "-c", program, *arguments], cwd=source, env=environment, check=True,
                   stdout=subprocess.DEVNULL)  # fmt: skip
    return json.loads(document.read_text(encoding="utf-8"))


def compare(example: str, new: object, old: object) -> int:
    """Print the numbers that differ and return how many do."""
    here, there = dict(numbers(new)), dict(numbers(old))
    common = here.keys() & there.keys()
    differ = [k for k in here if k in common and here[k] != there[k]]
    print(f"{example}: {len(common)} numbers in both, {len(differ)} differ, "
          f"{len(here.keys() - common)} only here, {len(there.keys() - common)} only there")  # fmt: skip
    for key in differ[:12]:
        print(f"    {key}: {here[key]!r} here, {there[key]!r} there{_relative(here[key], there[key])}")
    for where, keys in (("here", here.keys() - common), ("there", there.keys() - common)):
        for key in sorted(keys)[:6]:
            print(f"    only {where}: {key}")
    return len(differ)


def _relative(a: object, b: object) -> str:
    if not isinstance(a, int | float) or not isinstance(b, int | float) or not math.isfinite(a) or not b:
        return ""
    return f" ({(a - b) / abs(b):+.1e})"


def main(revision: str) -> int:
    """Run both versions on every example; return the number of numbers that differ."""
    with tempfile.TemporaryDirectory() as place:
        other = Path(place) / "other"
        subprocess.run(["git", "worktree", "add", "--detach", str(other), revision], cwd=REPOSITORY, check=True,
                       capture_output=True)  # fmt: skip
        try:
            total = 0
            for example, command in EXAMPLES.items():
                documents = []
                for name, source in (("here", REPOSITORY), ("there", other)):
                    folder = Path(place) / name
                    folder.mkdir(exist_ok=True)
                    documents.append(run(source, example, command, folder))
                total += compare(example, *documents)
            return total
        finally:
            subprocess.run(["git", "worktree", "remove", "--force", str(other)], cwd=REPOSITORY, check=False)


if __name__ == "__main__":
    if len(sys.argv) != 2:
        sys.exit("usage: python benchmarks/compare_versions.py REVISION")
    sys.exit(1 if main(sys.argv[1]) else 0)
