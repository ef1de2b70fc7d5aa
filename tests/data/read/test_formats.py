"""Every format: a sample with known contents gives the same record, and the reader conforms."""

import gc
import pickle
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tests.data.read.samples import HEADING, SAMPLES, SPEED, TIME, Sample

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout, Log, format_of, read_log, reader_of
from seatrial.data.read.assemble import assemble_record
from seatrial.testing import check_reader


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("samples")


@cache
def written(folder: Path, name: str) -> Path:
    """The sample file, written once."""
    SAMPLES[name].write(folder / name)
    return folder / name


def log_of(sample: Sample, path: Path, layout: Layout | None = None) -> Log:
    """What the reader returns, as it crosses from its process; that of .mat in a process of its own, as all in use."""
    wanted = layout or sample.layout
    return read_log(path, wanted) if sample.format == "mat" else pickle.loads(pickle.dumps(sample.read(path, wanted)))


@pytest.mark.parametrize("sample", SAMPLES.values(), ids=SAMPLES)
def test_a_sample_is_read_as_it_was_written(sample: Sample, folder: Path) -> None:
    path = written(folder, sample.file)
    assert format_of(path) == sample.format
    record = assemble_record(log_of(sample, path), sample.layout, "")
    time = record.time - sample.start
    np.testing.assert_allclose(time, TIME[: len(record)] if len(record) != len(TIME) else TIME, atol=1e-5)
    np.testing.assert_allclose(record["u"], np.interp(time, TIME, SPEED), atol=sample.tolerance)
    np.testing.assert_allclose(np.degrees(record["psi"]), np.interp(time, TIME, HEADING), atol=5e-3)


@pytest.mark.parametrize("sample", SAMPLES.values(), ids=SAMPLES)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # asammdf closes what it did not open
def test_readers_conform(sample: Sample, folder: Path) -> None:
    # a damaged .mat file can end the process in which scipy reads it
    path = written(folder, sample.file)
    content = path.read_bytes()

    def read(file: Path, layout: Layout) -> Log:
        is_damaged = sample.format == "mat" and file.is_file() and file.read_bytes() != content
        return (reader_of("mat") if is_damaged else sample.read)(file, layout)

    check_reader(read, path, sample.layout)
    if path.suffix == ".mf4":
        gc.collect()  # what asammdf leaves of a damaged file complains when it is deleted: here, not in another test


@pytest.mark.parametrize("file", [name for name, sample in SAMPLES.items() if "/" in str(sample.u.source)])
def test_a_topic_that_is_missing_is_named(file: str, folder: Path) -> None:
    sample = SAMPLES[file]
    layout = Layout(sample.format, ColumnSpec("time", "", "s"), (ColumnSpec("u", "no/such/topic", "m/s"),))
    with pytest.raises(InputError, match=r"no topic 'no/such'|no column 'no/such/topic'"):
        assemble_record(log_of(sample, written(folder, file), layout), layout, "")


def test_parameters_and_events_of_autopilots_are_kept(folder: Path) -> None:
    log = log_of(SAMPLES["run.bin"], written(folder, "run.bin"))
    assert log.parameters == {"SERVO1_FUNCTION": 26.0, "SERVO1_REVERSED": 1.0}
    assert [(event.time, event.name) for event in log.events] == [(0.0, "MODE MANUAL"), (6.0, "MODE AUTO")]
    assert log_of(SAMPLES["run.ulg"], written(folder, "run.ulg")).parameters["CA_ROTOR0_PX"] == 0.25
    log = log_of(SAMPLES["run.tlog"], written(folder, "run.tlog"))
    assert [event.name for event in log.events] == ["MODE MANUAL"] and log.parameters["SERVO1_FUNCTION"] == 26.0


def test_units_that_a_file_states_are_kept(folder: Path) -> None:
    for file in ("run.xlsx", "run.mf4", "run.h5", "run.tdms"):
        (table,) = log_of(SAMPLES[file], written(folder, file)).tables
        assert table.units[table.names.index("speed")] == "m/s"
