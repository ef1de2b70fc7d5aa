"""FMI 2.0 for co-simulation: the exported C with the functions of the interface, compiled for this platform."""

import hashlib
import io
import math
import os
import shutil
import struct
import subprocess
import tempfile
import zipfile
from dataclasses import dataclass
from pathlib import Path

from seatrial.core.text.words import printable
from seatrial.core.values import InputError
from seatrial.exporting.c_source import export_c
from seatrial.exporting.identified_range import RANGE_USE, identified_range, range_text
from seatrial.exporting.source import (
    ExportSource,
    Variable,
    input_variables,
    output_variables,
    parameter_variables,
    plain,
    provenance_lines,
    state_variables,
)
from seatrial.exporting.target import Export
from seatrial.exporting.templating import rendered
from seatrial.numerics.kernels.integrate import DIVERGED
from seatrial.numerics.platform import library_suffix, system_name

MAX_STEP = "max_step"
_STEP = 0.1  # s, internal step: that of `simulate`
_OUTSIDE = "outside_identified_range"
_ZIP_DATE = (1980, 1, 1, 0, 0, 0)  # the earliest that a zip file holds, so that the same model gives the same bytes
_BASE_UNITS = {
    "m": {"m": 1}, "m/s": {"m": 1, "s": -1}, "m/s^2": {"m": 1, "s": -2}, "rad": {"rad": 1}, "s": {"s": 1},
    "rad/s": {"rad": 1, "s": -1}, "rps": {"s": -1}, "1/s": {"s": -1}, "kg": {"kg": 1}, "kg m^2": {"kg": 1, "m": 2},
    "N": {"kg": 1, "m": 1, "s": -2}, "N m": {"kg": 1, "m": 2, "s": -2}, "kg/m^3": {"kg": 1, "m": -3}, "m^2": {"m": 2},
}  # fmt: skip
"""Unit -> exponents of SI base units; others are named only."""
_DISPLAY_UNITS = {"rad": ("deg", math.degrees(1.0)), "rad/s": ("deg/s", math.degrees(1.0))}
_OPTIONS = ("-O2", "-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-shared", "-fPIC", "-fvisibility=hidden")


@dataclass(frozen=True)
class FmuVariable:
    """A real variable of modelDescription.xml; its value reference is its place."""

    name: str
    unit: str
    note: str
    causality: str
    variability: str = "continuous"
    initial: str = ""
    start: float | None = None
    min: float | None = None
    max: float | None = None


def export_fmu(source: ExportSource, name: str) -> Export:
    """Return ``name.fmu``: description, C sources and, where there is a compiler, the binary for this platform.

    Raises:
        InputError: a name is no C identifier or belongs to the FMU, or a parameter has no value.
    """
    files = {f"sources/{n}": content for n, content in export_c(source, name).files.items()}
    values = _template_values(source, name, files)
    files["sources/fmu.c"] = rendered("fmu.c", **values)
    files["modelDescription.xml"] = rendered("modelDescription.xml", **values)
    binary, note = compiled_binary(files, name)
    if binary:
        files[f"binaries/{platform_folder()}/{name}{library_suffix()}"] = binary
    return Export({f"{name}.fmu": _zipped(files)}, (note, range_text(source)))


def variables(source: ExportSource) -> tuple[FmuVariable, ...]:
    """Return the real variables: states, inputs, outputs, parameters, the internal step and the use of the range.

    Raises:
        InputError: the model has a name of the FMU's own.
    """
    model, approach = source.model, source.file.approach

    def start(variable: Variable) -> float:
        return float(approach.get(variable.name, 0.0))

    rows = [
        *(
            FmuVariable(v.name, v.unit, v.note, "output", initial="exact", start=start(v))
            for v in state_variables(model)
        ),
        *(FmuVariable(v.name, v.unit, v.note, "input", start=start(v)) for v in input_variables(model)),
        *(FmuVariable(v.name, v.unit, v.note, "output", initial="calculated") for v in output_variables(model)),
    ]
    for v, p in zip(parameter_variables(model), model.parameters, strict=True):
        low, high = (x if math.isfinite(x) else None for x in (p.lower, p.upper))
        rows.append(FmuVariable(v.name, v.unit, v.note, "parameter", "tunable", "exact", p.value, low, high))
    rows.append(FmuVariable(MAX_STEP, "s", "longest internal step", "parameter", "tunable", "exact", _STEP))
    if identified_range(source):
        note = f"above 1 outside the identified range. {range_text(source)}"
        rows.append(FmuVariable(RANGE_USE, "", note, "output", initial="calculated"))
    names = [row.name for row in rows]
    clash = next((n for n in (MAX_STEP, RANGE_USE, _OUTSIDE) if names.count(n) + (n == _OUTSIDE) > 1), "")
    if clash:
        raise InputError(f"'{clash}' of model '{model.name}' is a name of the FMU's own; rename it in the model")
    return tuple(rows)


def compiled_binary(files: dict[str, bytes], name: str) -> tuple[bytes, str]:
    """Return the library for this platform and a sentence on it; no bytes where it cannot be compiled."""
    sources = "the FMU holds C sources only, which most importers compile"
    compiler = next((c for c in (os.environ.get("CC", ""), "cc", "gcc", "clang") if c and shutil.which(c)), None)
    if compiler is None:
        return b"", f"No C compiler was found: {sources}; install gcc or set CC to have the binary as well."
    with tempfile.TemporaryDirectory() as place:
        for path, content in files.items():
            if path.startswith("sources/"):
                (Path(place) / Path(path).name).write_bytes(content)
        command = [compiler, *_OPTIONS, "fmu.c", f"{name}.c", "-o", "binary", "-lm"]
        done = subprocess.run(command, cwd=place, capture_output=True, text=True, check=False)
        if done.returncode != 0:
            reason = printable(next(iter(done.stderr.splitlines()), "no message"))
            return b"", f"The C compiler '{compiler}' failed ({reason}): {sources}."
        return (Path(place) / "binary").read_bytes(), f"Binary for {platform_folder()}, compiled by {compiler}."


def platform_folder() -> str:
    """Return the folder of this platform's binary in an FMU (FMI 2.0, section 2.3)."""
    return f"{system_name()}{8 * struct.calcsize('P')}"


def _template_values(source: ExportSource, name: str, files: dict[str, bytes]) -> dict[str, object]:
    model, rows = source.model, variables(source)
    has_range = rows[-1].name == RANGE_USE
    indices = [i for i, row in enumerate(rows, start=1) if row.causality == "output"]
    calculated = [i for i in indices if rows[i - 1].initial == "calculated"]
    last = [len(rows) + 1] if has_range else []
    bounds = [(p.lower, p.upper) for p in model.parameters]
    units = sorted({row.unit for row in rows if row.unit})
    return {
        "name": name,
        "NAME": name.upper(),
        "guid": hashlib.sha256(b"\0".join(files.values())).hexdigest()[:32],  # of 32 digits, as a GUID has
        "date": source.date,
        "head": [*provenance_lines(source), range_text(source)],
        "description": plain(f"{model.equations.meaning or model.name}; {range_text(source)}"),
        "equations": model.equation_hash,
        "reversed": " ".join(i.name for i in model.inputs if i.is_reversed),
        "variables": rows,
        "units": [(unit, _BASE_UNITS.get(unit), _DISPLAY_UNITS.get(unit)) for unit in units],
        "has_range": has_range,
        "is_affine": model.is_affine,
        "output_indices": indices + last,
        "initial_indices": calculated + last,
        "start_x": ", ".join(repr(float(row.start or 0.0)) for row in rows[: len(model.states)]),
        "start_u": ", ".join(repr(float(source.file.approach.get(n, 0.0))) for n in (*model.input_names, "")),
        "lower": ", ".join([*(_c_number(low) for low, _ in bounds), "0.0"]),
        "upper": ", ".join([*(_c_number(high) for _, high in bounds), "0.0"]),
        "max_step": _STEP,
        "real_count": len(rows),
        "diverged": DIVERGED,
    }


def _c_number(value: float) -> str:
    return repr(value) if math.isfinite(value) else ("-" if value < 0.0 else "") + "HUGE_VAL"


def _zipped(files: dict[str, bytes]) -> bytes:
    stream = io.BytesIO()
    with zipfile.ZipFile(stream, "w", zipfile.ZIP_DEFLATED) as archive:
        for path, content in files.items():
            archive.writestr(zipfile.ZipInfo(path, _ZIP_DATE), content, zipfile.ZIP_DEFLATED)
    return stream.getvalue()
