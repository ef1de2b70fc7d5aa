"""Every format: a sample with known contents gives the same record, and the reader conforms."""

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from tests.data.read.samples import HEADING, SAMPLES, SPEED, TIME, Sample

from seatrial.core.values import InputError
from seatrial.data.read import ColumnSpec, Layout, format_of, read_log, read_record, reader_of
from seatrial.testing import check_reader


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return tmp_path_factory.mktemp("samples")


@cache
def written(folder: Path, name: str) -> Path:
    """The sample file, written once."""
    SAMPLES[name].write(folder / name)
    return folder / name


@pytest.mark.parametrize("sample", SAMPLES.values(), ids=SAMPLES)
def test_a_sample_is_read_as_it_was_written(sample: Sample, folder: Path) -> None:
    path = written(folder, sample.file)
    assert format_of(path) == sample.format
    record = read_record(path, sample.layout)
    time = record.time - sample.start
    np.testing.assert_allclose(time, TIME[: len(record)] if len(record) != len(TIME) else TIME, atol=1e-5)
    np.testing.assert_allclose(record["u"], np.interp(time, TIME, SPEED), atol=sample.tolerance)
    np.testing.assert_allclose(np.degrees(record["psi"]), np.interp(time, TIME, HEADING), atol=5e-3)


@pytest.mark.parametrize("sample", SAMPLES.values(), ids=SAMPLES)
@pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # asammdf closes what it did not open
def test_readers_conform(sample: Sample, folder: Path) -> None:
    # a damaged .mat file can end the process in which scipy reads it
    read = reader_of("mat") if sample.format == "mat" else sample.read
    check_reader(read, written(folder, sample.file), sample.layout)


@pytest.mark.parametrize("file", [name for name, sample in SAMPLES.items() if "/" in str(sample.u.source)])
def test_a_topic_that_is_missing_is_named(file: str, folder: Path) -> None:
    sample = SAMPLES[file]
    layout = Layout(sample.format, ColumnSpec("time", "", "s"), (ColumnSpec("u", "no/such/topic", "m/s"),))
    with pytest.raises(InputError, match=r"no topic 'no/such'|no column 'no/such/topic'"):
        read_record(written(folder, file), layout)


def test_parameters_and_events_of_autopilots_are_kept(folder: Path) -> None:
    log = read_log(written(folder, "run.bin"), SAMPLES["run.bin"].layout)
    assert log.parameters == {"SERVO1_FUNCTION": 26.0, "SERVO1_REVERSED": 1.0}
    assert [(event.time, event.name) for event in log.events] == [(0.0, "MODE MANUAL"), (6.0, "MODE AUTO")]
    assert read_log(written(folder, "run.ulg"), SAMPLES["run.ulg"].layout).parameters["CA_ROTOR0_PX"] == 0.25
    log = read_log(written(folder, "run.tlog"), SAMPLES["run.tlog"].layout)
    assert [event.name for event in log.events] == ["MODE MANUAL"] and log.parameters["SERVO1_FUNCTION"] == 26.0


def test_units_that_a_file_states_are_kept(folder: Path) -> None:
    for file in ("run.xlsx", "run.mf4", "run.h5", "run.tdms"):
        (table,) = read_log(written(folder, file), SAMPLES[file].layout).tables
        assert table.units[table.names.index("speed")] == "m/s"
