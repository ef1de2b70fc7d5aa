"""Compare results with the recorded ones: `python benchmarks/golden.py [NAME ...] [--class CLASS] [--record]`.

`golden.toml` names the trials, the commands each runs and its class, which says how near a result stays to the recorded
one: `move` to the bit; `redraw` coefficients and ends of intervals within 0.01 standard errors, the same findings and
grade; `replaced` coefficients within 0.1 standard errors, held-out errors up to 1.01 and objectives up to 1.005 times
the recorded ones, limits kept. `--class` compares all of them by that class. A trial with `should` is held to what is
typed in there instead; with `fails` it is not right yet, and the word names the cure. A row of `[[difference]]` is a
difference that is wanted, with its reason. `--record` writes `golden.json`, without times and versions.

Real records lie in SEATRIAL_DATA, reproducers in `repro` beside it; trials whose files are not there are left out.
"""

import argparse
import json
import math
import os
import re
import shlex
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).parents[1]
TRIALS = Path(__file__).with_name("golden.toml")
RECORDED = Path(__file__).with_name("golden.json")
CLASSES = ("move", "redraw", "replaced")
DEVIATIONS = {"redraw": 0.01, "replaced": 0.1}  # standard errors by which a coefficient may differ; set for the redraw
ERROR_RATIO, OBJECTIVE_RATIO = 1.01, 1.005  # of a replaced mechanism over the recorded; set for the redraw
ROUNDING = 1e-9  # relative difference of numbers without a standard error that counts as none
SUITE_CPU = 5.0  # s of processor time below which a trial runs in the suite, too
WORKERS = 2  # cores that `make golden` counts on
_GRADE = re.compile(r"Error, held out [^+!]*?: (closely|well|roughly|poorly|not at all)\b")
_INTERVAL = ("estimate", "standard_error", "lower", "upper")
_WITH_JSON = ("identify", "check", "tune", "design", "predict")
_WITH_FOLDER = ("identify", "tune", "design")

Outcome = dict[str, object]


@dataclass(frozen=True)
class GoldenTrial:
    """A trial of golden.toml.

    Attributes:
        name: by which the results are recorded.
        tolerance: its class, one of `CLASSES`.
        run: commands without the program's name; `{out}` is a folder of the run.
        folder: in which they run, seen from the repository, or `repro/...` beside the real records.
        records: folder of real records that must be there; empty: none.
        should: what holds of the results, see `shortfalls`; empty: they are compared with the recorded ones.
        fails: one word for the cure of what is not right yet; empty: it is right.
        edited: file, replaced, by: an example that is written to `{out}/edited.toml`, `{folder}` for the folder.
        cpu: s of processor time that it took where it was recorded.
    """

    name: str
    tolerance: str
    run: tuple[str, ...]
    folder: str = ""
    records: str = ""
    should: Mapping[str, object] = field(default_factory=dict)
    fails: str = ""
    edited: Mapping[str, str] = field(default_factory=dict)
    cpu: float = 0.0

    @property
    def path(self) -> Path:
        """Return the folder in which the commands run."""
        return data_folder().parent / self.folder if self.folder.startswith("repro") else REPOSITORY / self.folder

    @property
    def is_here(self) -> bool:
        """Return whether the files of the trial are on this machine."""
        return self.path.is_dir() and (data_folder() / self.records).is_dir() if self.records else self.path.is_dir()


def data_folder() -> Path:
    """Return the folder of real records: SEATRIAL_DATA, or ../shared/data beside the checkout."""
    return Path(os.environ.get("SEATRIAL_DATA") or REPOSITORY.parent / "shared" / "data")


def read_trials() -> tuple[list[GoldenTrial], list[dict[str, str]]]:
    """Return the trials of golden.toml, and the differences that are wanted."""
    document = tomllib.loads(TRIALS.read_text(encoding="utf-8"))
    trials = [
        GoldenTrial(**{"tolerance": row.pop("class"), **row, "run": tuple(row["run"])}) for row in document["trial"]
    ]
    return trials, document.get("difference", [])


Execute = Callable[[str, list[str], Path], tuple[int, str]]


def in_a_process(name: str, arguments: list[str], folder: Path) -> tuple[int, str]:
    """Run a command in a folder; return its exit code and what it prints."""
    program = [sys.executable, "-c", "from seatrial.cli import main; main()", name]
    program = [*([sys.executable] if name == "python" else program), *arguments]
    environment = {name: value for name, value in os.environ.items() if name != "COLUMNS"}
    environment |= {"SEATRIAL_DATA": str(data_folder()), "NUMBA_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1"}
    done = subprocess.run(program, cwd=folder, env=environment, capture_output=True, check=False)
    return done.returncode, (done.stdout + done.stderr).decode(errors="replace")


def run_trial(trial: GoldenTrial, execute: Execute = in_a_process) -> tuple[Outcome, float]:
    """Run the commands of a trial; return what is recorded of it, and its processor time [s] in other processes."""
    begin = _children_cpu()
    with tempfile.TemporaryDirectory() as out:
        if edit := trial.edited:
            text = (REPOSITORY / edit["file"]).read_text(encoding="utf-8")
            new = edit["by"].replace("{folder}", trial.path.as_posix())
            (Path(out) / "edited.toml").write_text(text.replace(edit["replaced"], new), encoding="utf-8")
        steps = [_run_command(line.replace("{out}", out), trial.path, Path(out), execute) for line in trial.run]
        files = {name: _text_of(Path(out) / name) for name in trial.should.get("files", {})}  # type: ignore[attr-defined]
    outcome: Outcome = {"exits": [step.pop("exit") for step in steps]}
    outcome["files"] = files
    outcome["tuned"] = [step["gains"] for step in steps if "gains" in step]
    outcome["text"] = "\n".join(str(step.pop("text")) for step in steps)
    for step in steps:
        outcome |= step
    return outcome, _children_cpu() - begin


def _children_cpu() -> float:
    times = os.times()
    return times.children_user + times.children_system


def _run_command(line: str, folder: Path, out: Path, execute: Execute) -> Outcome:
    name, *arguments = shlex.split(line)
    document = out / "result.json"
    document.unlink(missing_ok=True)
    arguments = [path for part in arguments for path in expanded(part, folder)]
    if name in _WITH_JSON:
        arguments += ["--json", str(document)]
    if name in _WITH_FOLDER and "--out" not in arguments:
        arguments += ["--out", str(out / "results")]
    code, text = execute(name, arguments, folder)
    result = json.loads(document.read_text(encoding="utf-8")) if document.exists() else {}
    outcome: Outcome = {"exit": code, "text": text} | _extracted(result, text)
    if name == "init" and "--out" in arguments:
        draft = Path(arguments[arguments.index("--out") + 1])
        draft = draft if draft.is_absolute() else folder / draft
        outcome["draft"] = _text_of(draft)
    return outcome


def _text_of(path: Path) -> str:
    return path.read_text(encoding="utf-8") if path.exists() else ""


def expanded(part: str, folder: Path) -> list[str]:
    """Return the files of a pattern in a folder; what is no pattern as it is."""
    if "*" not in part:
        return [part]
    base = Path(part) if Path(part).is_absolute() else folder / part
    return sorted(str(path) for path in base.parent.glob(base.name))


def _extracted(result: Any, text: str) -> Outcome:
    """What is compared of a result: a fit, a tuning, a design, or findings alone."""
    document = {"findings": result} if isinstance(result, list) else result
    outcome: Outcome = {"codes": _codes(document["findings"])} if "findings" in document else {}
    if "coefficients" in document and "validation" in document:
        free = [c for c in document["coefficients"] if not c["fixed"]]
        grade = _GRADE.search(" ".join(text.split()))
        outcome["coefficients"] = {c["name"]: [c[key] for key in _INTERVAL] for c in free}
        outcome["errors"] = {p["record"]: p["rms"] for p in document["validation"]}
        outcome["grade"] = grade[1] if grade else ""
    elif "chosen" in document:
        outcome |= {key: document["chosen"][key] for key in ("gains", "objectives", "violated")}
    elif "designed" in document:
        outcome["objectives"] = document["designed"]["relative_error"]
    return outcome


def _codes(findings: Sequence[Mapping[str, str]]) -> list[str]:
    return sorted({f["code"] for f in findings if f["severity"] != "info"})


def differences(recorded: object, present: object, tolerance: str, place: str = "") -> Iterator[str]:
    """Yield a row for each value that differs by more than the class allows."""
    if isinstance(recorded, Mapping) and isinstance(present, Mapping):
        for name in sorted(recorded.keys() | present.keys()):
            inner = f"{place}.{name}" if place else name
            if ".coefficients." in f".{inner}" and tolerance != "move" and name in recorded and name in present:
                yield from _coefficient_rows(recorded[name], present[name], DEVIATIONS[tolerance], inner)
            else:
                yield from differences(recorded.get(name), present.get(name), tolerance, inner)
    elif not _agrees(recorded, present, tolerance, place):
        yield f"{place}: {_short(recorded)} -> {_short(present)}"


def _agrees(recorded: object, present: object, tolerance: str, place: str) -> bool:
    if tolerance == "replaced" and place.startswith(("gains.", "codes", "grade")):
        return True
    if tolerance == "move" or not isinstance(recorded, int | float) or not isinstance(present, int | float):
        return recorded == present
    ratio = {"errors": ERROR_RATIO, "objectives": OBJECTIVE_RATIO}.get(place.partition(".")[0], 1.0)
    if tolerance == "replaced" and ratio > 1.0:
        return present <= ratio * recorded
    slack = DEVIATIONS["redraw"] if ratio > 1.0 or place.startswith("gains") else ROUNDING
    return abs(present - recorded) <= slack * abs(recorded)


def _coefficient_rows(recorded: Sequence, present: Sequence, deviations: float, place: str) -> Iterator[str]:
    error = recorded[1]
    for what, a, b in zip(_INTERVAL, recorded, present, strict=True):
        if a is None or b is None:
            if a is not b:
                yield f"{place} {what}: {a} -> {b}"
        elif abs(b - a) > (deviations * error if error else ROUNDING * abs(a)):
            by = f", {abs(b - a) / error:.3g} standard errors" if error else ""
            yield f"{place} {what}: {a:.6g} -> {b:.6g}{by}"


def _short(value: object) -> str:
    text = json.dumps(value)
    return text if len(text) < 80 else f"{text[:77]}..."  # characters of a row; chosen


def shortfalls(should: Mapping[str, object], outcome: Mapping) -> list[str]:
    """Return what a result lacks of what it should be.

    Keys of `should`: exits, the exit codes allowed; says and never, patterns of the printed text; drafted and
    not_drafted, of the trial file that `init` writes; files, of files written; codes and no_codes, of findings; within,
    name -> range of an estimate; holds, name -> value inside its interval; errors, name -> largest error of a run that
    was not fitted; equal_gains, largest relative difference between the gains of all loops tuned.
    """
    lacks = []
    if "exits" in should and not set(outcome["exits"]) <= set(should["exits"]):  # type: ignore[arg-type]
        lacks.append(f"exits {outcome['exits']}")
    printed = " ".join(str(outcome["text"]).split())
    for key, text, is_wanted in (
        ("says", printed, True), ("never", printed, False), ("drafted", outcome.get("draft", ""), True),
        ("not_drafted", outcome.get("draft", ""), False),
    ):  # fmt: skip
        for pattern in should.get(key, ()):  # type: ignore[attr-defined]
            if bool(re.search(pattern, text, re.MULTILINE)) is not is_wanted:
                lacks.append(f"{key} '{pattern}'")
    for name, patterns in should.get("files", {}).items():  # type: ignore[attr-defined]
        lacks += [f"{name} '{p}'" for p in patterns if not re.search(p, outcome["files"][name])]
    codes = set(outcome.get("codes", ()))
    lacks += [f"finding {code}" for code in should.get("codes", ()) if code not in codes]  # type: ignore[attr-defined]
    lacks += [f"no finding {code}" for code in should.get("no_codes", ()) if code in codes]  # type: ignore[attr-defined]
    return [*lacks, *_estimate_shortfalls(should, outcome)]


def _estimate_shortfalls(should: Mapping, outcome: Mapping) -> Iterator[str]:
    coefficients = outcome.get("coefficients", {})
    for name, (lower, upper) in should.get("within", {}).items():
        if name not in coefficients or not lower <= coefficients[name][0] <= upper:
            yield f"{name} within {lower} to {upper}"
    first, *others = outcome["tuned"] or [{}]
    difference = max((abs(gains[n] - first[n]) for gains in others for n in first), default=0.0)
    if difference > should.get("equal_gains", math.inf) * max(map(abs, first.values()), default=1.0):
        yield f"equal gains: {outcome['tuned']}"
    for name, truth in should.get("holds", {}).items():
        ends = coefficients.get(name, (None, None, None, None))[2:]
        if None in ends or not ends[0] <= truth <= ends[1]:
            yield f"{truth} inside the interval of {name}"
    for name, largest in should.get("errors", {}).items():
        errors = [rms[name] for rms in outcome.get("errors", {}).values() if name in rms]
        if not errors or max(errors) > largest:
            yield f"{name} up to {largest}"


def rows_of(trial: GoldenTrial, outcome: Outcome, recorded: Mapping, tolerance: str = "") -> list[str]:
    """Return a row for each way in which a trial is not as recorded, or not as it should be."""
    if trial.should:
        lacks = shortfalls(trial.should, outcome)
        if trial.fails:
            return [] if lacks else [f"{trial.name}: is right now; strike fails = '{trial.fails}'"]
        return [f"{trial.name}: lacks {what}" for what in lacks]
    if trial.name not in recorded:
        return [f"{trial.name}: not recorded"]
    present = json.loads(json.dumps(recordable(outcome)))
    return [f"{trial.name}: {row}" for row in differences(recorded[trial.name], present, tolerance or trial.tolerance)]


def recordable(outcome: Outcome) -> Outcome:
    """Return what is kept of an outcome: no text."""
    return {key: value for key, value in outcome.items() if key not in ("text", "draft", "files", "tuned")}


def is_wanted(row: str, wanted: Sequence[Mapping[str, str]]) -> bool:
    """Return whether a row of golden.toml gives a reason for this difference."""
    return any(row.startswith(entry["row"]) and entry["reason"].strip() for entry in wanted)


def write(recorded: Mapping[str, Outcome]) -> None:
    """Write the recorded results, a line a trial."""
    lines = (f"{json.dumps(name)}: {json.dumps(recorded[name], sort_keys=True)}" for name in sorted(recorded))
    RECORDED.write_text("{\n" + ",\n".join(lines) + "\n}\n", encoding="utf-8")


def main() -> int:
    """Run the trials; compare them with what was recorded, or record them."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").partition("\n")[0])
    parser.add_argument("names", nargs="*", help="trials; all of them where none is named")
    parser.add_argument("--class", dest="tolerance", choices=CLASSES, default="", help="compare by this class")
    parser.add_argument("--record", action="store_true", help="record the present results")
    parser.add_argument("--workers", type=int, default=WORKERS)
    options = parser.parse_args()
    trials, wanted = read_trials()
    chosen = [t for t in trials if t.is_here and (not options.names or t.name in options.names)]
    recorded = json.loads(RECORDED.read_text(encoding="utf-8")) if RECORDED.exists() else {}
    rows: list[str] = []
    with ProcessPoolExecutor(options.workers) as pool:
        ordered = sorted(chosen, key=lambda t: -t.cpu)
        for trial, (outcome, cpu) in zip(ordered, pool.map(run_trial, ordered), strict=True):
            if options.record and not trial.should:
                recorded[trial.name] = recordable(outcome)
            new = rows_of(trial, outcome, recorded, options.tolerance)
            lacks = "; ".join(shortfalls(trial.should, outcome)) if trial.fails else ""
            note = f"expected to fail, {trial.fails}: {lacks}" if lacks else f"{len(new)} differences"
            print(f"{trial.name:34s}{trial.tolerance:10s}{cpu:7.1f} s CPU  {note}", flush=True)
            rows += new
    if options.record:
        write({t.name: recorded[t.name] for t in trials if t.name in recorded})
    absent = len(trials) - len([t for t in trials if t.is_here])
    unwanted = [row for row in rows if not is_wanted(row, wanted)]
    print(*(f"{'wanted: ' * (row not in unwanted)}{row}" for row in rows), sep="\n")
    print(f"{len(chosen)} trials, {len(unwanted)} differences without a reason, {absent} trials not on this machine")
    return int(bool(unwanted))


if __name__ == "__main__":
    sys.exit(main())
