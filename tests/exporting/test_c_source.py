"""Exported C compiles without a warning and takes the steps of the package's own simulation."""

import ctypes
import subprocess
from pathlib import Path

import numpy as np
import pytest
from benchmarks.export_c99 import (
    STRICT,
    complete_model,
    jacobian_error,
    random_states,
    step_error,
    write_and_compile,
)
from tests.exporting.conftest import ENVELOPE

import seatrial as st
from seatrial.core.results import IntervalBasis
from seatrial.core.values import Channel, InputError, Record, RecordKind
from seatrial.data.folder.model_file import ModelFile
from seatrial.estimation.information.extrapolation import extrapolation
from seatrial.exporting.c_source import export_c
from seatrial.exporting.source import ExportSource, plain, range_text, range_use
from seatrial.physics.models.published import kvlcc2

TOLERANCE = 1e-12  # of a step, relative: rounding, a thousand times over


@pytest.mark.parametrize("name", ["waterjet", "thrusters", "heave_pitch", "roll", "mmg_twin", "mmg_shallow"])
def test_a_step_is_that_of_the_simulation(name: str, compiler: str, tmp_path: Path, rng: np.random.Generator) -> None:
    assert compiler
    model = complete_model(name, rng)
    library = write_and_compile(model, tmp_path, name, "-O0")
    assert step_error(library, model, random_states(model, 2000, rng)) < TOLERANCE
    # a Jacobian has differences of large terms where a craft nearly rests
    assert jacobian_error(library, model, random_states(model, 50, rng)) < 1e-8


def test_a_model_of_one_s_own_without_inputs_or_parameters(compiler: str, tmp_path: Path) -> None:
    sheet = st.Sheet("pendulum", "a text book")
    phi, p = sheet.states("phi p")
    sheet.rate(phi, p)
    sheet.rate(p, -(phi**3))
    st.export(sheet.model(), "c99", tmp_path / "pendulum")
    done = subprocess.run([compiler, *STRICT, "-c", "pendulum.c"], cwd=tmp_path / "pendulum", capture_output=True)
    assert done.returncode == 0, done.stderr.decode()


def _range_use(file: ModelFile, folder: Path, compiler: str) -> ctypes.CDLL:
    st.export(file, "c99", folder / "ship")
    subprocess.run(
        [compiler, *STRICT, "-shared", "-fPIC", "ship.c", "-o", "s.so", "-lm"], cwd=folder / "ship", check=True
    )
    library = ctypes.CDLL(str(folder / "ship" / "s.so"))
    library.ship_range_use.restype = ctypes.c_double
    library.ship_range_use.argtypes = [ctypes.c_void_p] * 3
    return library


def test_the_range_is_that_of_the_extrapolation_index(
    kvlcc2_file: ModelFile, compiler: str, tmp_path: Path, rng: np.random.Generator
) -> None:
    """Hostile texts of the file stay within their comments, or this would not compile."""
    library = _range_use(kvlcc2_file, tmp_path, compiler)
    for _ in range(20):
        x = np.array([1.0, 0.3, 0.05, 1.0, 1.0, 1.0]) * rng.uniform(-1.0, 2.0, 6)
        u = np.array([rng.uniform(-0.7, 0.7), 10.0, 0.0, 0.0])
        channels = {
            s: Channel.from_notation(s, np.full(4, v)) for s, v in (*zip("uvr", x, strict=False), ("delta", u[0]))
        }
        record = Record("still", np.arange(4.0), channels, RecordKind.SIMULATED)
        index = extrapolation(record, ENVELOPE)
        assert index is not None
        assert library.ship_range_use(x.ctypes.data, x.ctypes.data, u.ctypes.data) == pytest.approx(
            index.index, rel=1e-12
        )


def test_the_same_day_gives_the_same_bytes(kvlcc2_file: ModelFile) -> None:
    source = ExportSource(kvlcc2_file, "model.toml", "2026-01-01")
    first, again = export_c(source, "ship").files, export_c(source, "ship").files
    assert first == again
    header = first["ship.h"].decode()
    for text in (
        "z_20_20 (training)",
        "2026-01-01",
        "rudder or nozzle angle, body-fixed, positive starboard",
        "0.75 m/s",
    ):
        assert text in header


@pytest.mark.parametrize("text", ["ends */ here", "a\nline", "a -- b", "trigraph ??/", 'quotes """', "back\\slash"])
def test_a_text_from_a_file_stays_in_its_comment(text: str) -> None:
    safe = plain(text)
    assert not any(mark in safe for mark in ("*/", "\n", "--", "??", '"""', "\\"))


@pytest.mark.parametrize("name", ["my-ship", "2ships", "int", "schiff_ü"])
def test_a_name_that_is_no_identifier_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(InputError, match=f"'{name}'.* is no C identifier"):
        st.export(kvlcc2(), "c99", tmp_path / name)
    assert list(tmp_path.iterdir()) == []


def test_a_symbol_that_is_no_identifier_is_refused(tmp_path: Path) -> None:
    sheet = st.Sheet("greek")
    (r,) = sheet.states("r")
    sheet.rate(r, -r * sheet.parameter("κ", 1.0))
    with pytest.raises(InputError, match="'κ' of model 'greek' is no C identifier; rename"):
        st.export(sheet.model(), "c99", tmp_path / "greek")


def test_the_range_of_a_craft_with_thrusters_holds_its_commands() -> None:
    envelope = {"fastest": 2.0, "slowest": 0.1, "command port ahead": 0.8, "command port astern": 0.5}
    basis = IntervalBasis(np.empty((0, 0)), 1.0, 1.0, training_envelope=envelope)
    file = ModelFile(st.models.model_named("thrusters"), interval_basis=basis)
    source = ExportSource(file, "model.toml", "2026-01-01")
    assert "command port ahead <= 80 %, command port astern <= 50 %" in range_text(source)
    use = range_use(source)
    assert use is not None
    values = {"u": 1.0, "v": 0.0, "zero_port": 0.0, "span_port": 1.0}
    symbols = {symbol: symbol.name for symbol in use.expression.free_symbols}
    for command, wanted in ((0.8, 1.0), (1.0, 1.2), (-0.9, 1.4)):
        at_command = {symbol: (values | {"command_1": command})[name] for symbol, name in symbols.items()}
        assert float(use.expression.subs(at_command)) == pytest.approx(wanted)
