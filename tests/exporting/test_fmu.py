"""An exported FMU validates, moves as the model does, and keeps to the rules of its interface."""

import zipfile
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
from benchmarks.export_c99 import complete_model

import seatrial as st
from seatrial.core.values import Channel, InputError, Record, RecordKind
from seatrial.data.folder.model_file import ModelFile
from seatrial.exporting.fmu import replay_fmu
from seatrial.physics.simulate import replay

fmpy = pytest.importorskip("fmpy", reason="FMPy is not installed: pip install 'seatrial[fmu]'")
from fmpy.fmi1 import FMICallException  # noqa: E402
from fmpy.fmi2 import FMU2Slave  # noqa: E402
from fmpy.validation import validate_fmu  # noqa: E402

TOLERANCE = 1e-9  # of the largest value of a channel over a zigzag


@pytest.fixture(scope="module")
def fmu_path(kvlcc2_file: ModelFile, compiler: str, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The tanker as an FMU."""
    assert compiler
    path = tmp_path_factory.mktemp("fmu") / "tanker.fmu"
    result = st.export(kvlcc2_file, "fmu", path)
    assert "compiled by" in result.notes[0]
    return path


class Craft:
    """An instance with its variables by name."""

    def __init__(self, path: Path, folder: Path) -> None:
        description = fmpy.read_model_description(str(path))
        self.references = {v.name: v.valueReference for v in description.modelVariables}
        identifier = description.coSimulation.modelIdentifier
        self.slave = FMU2Slave(
            guid=description.guid, unzipDirectory=str(folder), modelIdentifier=identifier, instanceName="craft"
        )
        self.slave.instantiate()

    def initialise(self) -> None:
        """End in step mode."""
        self.slave.setupExperiment()
        self.slave.enterInitializationMode()
        self.slave.exitInitializationMode()

    def set(self, name: str, value: float) -> None:
        """Set one variable."""
        self.slave.setReal([self.references[name]], [value])

    def get(self, *names: str) -> list[float]:
        """Return some variables."""
        return self.slave.getReal([self.references[n] for n in names])

    def run(self, rudder: float, steps: int = 50) -> list[float]:
        """Return the motion after some steps of 0.1 s with a constant rudder."""
        self.set("delta", rudder)
        for k in range(steps):
            self.slave.doStep(currentCommunicationPoint=0.1 * k, communicationStepSize=0.1)
        return self.get("u", "v", "r", "psi", "x0", "y0")


@pytest.fixture
def craft(fmu_path: Path, tmp_path: Path) -> Iterator[Callable[[], Craft]]:
    """Makes instances, which are freed at the end."""
    fmpy.extract(str(fmu_path), unzipdir=str(tmp_path))
    crafts: list[Craft] = []

    def make() -> Craft:
        crafts.append(Craft(fmu_path, tmp_path))
        return crafts[-1]

    yield make
    for one in crafts:
        one.slave.fmi2FreeInstance(one.slave.component)


def test_it_validates(fmu_path: Path) -> None:
    assert validate_fmu(str(fmu_path)) == []
    with zipfile.ZipFile(fmu_path) as archive:
        description = archive.read("modelDescription.xml").decode()
    for text in ("positive starboard", "|rudder| &lt;= 0.5 rad", 'variability="tunable"', 'unit="rad"'):
        assert text in description


def test_a_zigzag_is_that_of_the_simulation(fmu_path: Path, kvlcc2_file: ModelFile) -> None:
    record = st.simulate(kvlcc2_file, "zigzag:20/20")
    back = replay_fmu(fmu_path, record)
    for name in (*kvlcc2_file.model.states, "thrust"):
        assert np.max(np.abs(record[name] - back[name])) < TOLERANCE * np.max(np.abs(record[name])), name


def test_a_linear_model_whose_inputs_are_held(compiler: str, tmp_path: Path, rng: np.random.Generator) -> None:
    assert compiler
    model = complete_model("heave_pitch_zoh", rng)
    time = 0.1 * np.arange(100)
    channels = {n: Channel.from_notation(n, rng.normal(size=100) * size) for n, size in (("F3", 1e5), ("M5", 1e6),
                ("delta_f1", 0.1), ("delta_f2", 0.1))}  # fmt: skip
    channels |= {n: Channel.from_notation(n, np.zeros(100)) for n in model.states}
    record = Record("waves", time, channels, RecordKind.SIMULATED)
    st.export(model, "fmu", tmp_path / "plate.fmu")
    own, back = replay(model, record), replay_fmu(tmp_path / "plate.fmu", record)
    for name in model.states:
        assert np.max(np.abs(own[name] - back[name])) < TOLERANCE * np.max(np.abs(own[name])), name


def test_instances_do_not_know_one_another_and_reset_goes_back(craft: Callable[[], Craft]) -> None:
    one, other = craft(), craft()
    one.initialise()
    other.initialise()
    first, second = one.run(0.2), other.run(-0.2)
    assert first[3] > 0.03 and second[3] < -0.03
    one.slave.reset()
    one.initialise()
    assert one.run(0.2) == first


def test_a_saved_state_continues_to_the_last_bit(craft: Callable[[], Craft]) -> None:
    one, other = craft(), craft()
    one.initialise()
    one.set("D_P", 0.25)
    one.run(0.2)
    state = one.slave.getFMUState()
    saved = one.slave.serializeFMUState(state)
    ahead = one.run(-0.1)
    one.slave.setFMUState(state)
    assert one.run(-0.1) == ahead
    one.slave.freeFMUState(state)
    restored = other.slave.deserializeFMUState(saved)
    other.slave.setFMUState(restored)
    assert other.run(-0.1) == ahead
    other.slave.freeFMUState(restored)


def test_it_says_when_the_motion_leaves_the_identified_range(craft: Callable[[], Craft]) -> None:
    one = craft()
    one.initialise()
    assert one.get("range_use")[0] <= 1.0
    assert one.slave.getBoolean([0]) == [0]
    one.run(0.6, steps=100)  # rad, beyond the 0.5 of the training runs
    assert one.get("range_use")[0] > 1.0
    assert one.slave.getBoolean([0]) == [1]


def test_wrong_values_are_refused(craft: Callable[[], Craft]) -> None:
    one = craft()
    for name, value in (("u", np.nan), ("delta", np.inf), ("max_step", 0.0), ("thrust", 1.0)):
        with pytest.raises(FMICallException):
            one.set(name, value)
    one.set("rho", 0.0)  # neither mass nor added mass
    one.set("m", 0.0)
    one.slave.setupExperiment()
    one.slave.enterInitializationMode()
    with pytest.raises(FMICallException):
        one.slave.exitInitializationMode()
    one.slave.reset()
    one.initialise()
    with pytest.raises(FMICallException):  # a state, in a running simulation
        one.set("u", 1.0)


def test_without_a_compiler_the_sources_are_written_and_said(
    kvlcc2_file: ModelFile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.delenv("CC", raising=False)
    result = st.export(kvlcc2_file, "fmu", tmp_path / "tanker.fmu")
    assert result.notes[0].startswith("No C compiler was found: the FMU holds C sources only")
    with zipfile.ZipFile(tmp_path / "tanker.fmu") as archive:
        assert sorted(archive.namelist()) == [
            "modelDescription.xml", "sources/fmu.c", "sources/tanker.c", "sources/tanker.h",
        ]  # fmt: skip
    record = st.simulate(kvlcc2_file, "turning-circle:10", duration=10.0)
    with pytest.raises(InputError, match=r"tanker.fmu' cannot be run as an FMU on this platform"):
        replay_fmu(tmp_path / "tanker.fmu", record)


def test_a_compiler_that_fails_is_named(
    kvlcc2_file: ModelFile, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    broken = tmp_path / "brokencc"
    broken.write_text("#!/bin/sh\necho 'no licence' >&2\nexit 1\n")
    broken.chmod(0o755)
    monkeypatch.setenv("CC", str(broken))
    note = st.export(kvlcc2_file, "fmu", tmp_path / "tanker.fmu").notes[0]
    assert "brokencc' failed (no licence): the FMU holds C sources only" in note


def test_bad_input_of_a_replay_is_one_sentence(
    fmu_path: Path, kvlcc2_file: ModelFile, tmp_path: Path, run_command: Callable[..., int],
    capsys: pytest.CaptureFixture[str],
) -> None:  # fmt: skip
    record = st.simulate(kvlcc2_file, "turning-circle:10", duration=10.0)
    st.write_record(record, tmp_path / "turn.csv")
    (tmp_path / "torn.fmu").write_bytes(fmu_path.read_bytes()[:1000])
    with pytest.raises(InputError, match=r"torn.fmu' cannot be run as an FMU"):
        replay_fmu(tmp_path / "torn.fmu", record)
    bare = Record("bare", record.time, {"psi": record.channel("psi")})
    with pytest.raises(InputError, match="has no channel 'delta', an input of FMU"):
        replay_fmu(fmu_path, bare)
    assert run_command("simulate", fmu_path, "--manoeuvre", "zigzag:20/20", "--out", tmp_path / "z.csv") == 2
    assert "an FMU is run with the inputs of a record" in capsys.readouterr().err
    assert run_command("simulate", fmu_path, "--inputs", tmp_path / "turn.csv", "--out", tmp_path / "back.csv") == 0
    assert "against turning-circle:10: rms" in capsys.readouterr().out
    assert len(st.read_record(tmp_path / "back.csv")) == len(record)
