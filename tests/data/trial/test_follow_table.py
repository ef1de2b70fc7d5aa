"""`[follow]` of a trial file: what it says in SI, and what is refused, in one sentence naming the key."""

from pathlib import Path

import pytest

from seatrial.core.values import InputError
from seatrial.data.trial import load_trial
from seatrial.data.trial.runs import require_stream, with_source
from seatrial.data.trial.settings import StreamSource
from seatrial.data.trial.trial import Role

SHIP = '[ship]\nname = "craft"\nL = 9.8\n[model]\nname = "nomoto"\n'
STREAM = """[follow]
source = "file"
file = "log.csv"
rate = 10
time = { column = "t", unit = "s" }
[follow.channels]
r = { column = "r", unit = "deg/s" }
delta = { column = 3, unit = "deg", positive = "port" }
"""


def written(folder: Path, text: str) -> Path:
    path = folder / "trial.toml"
    path.write_text(text, encoding="utf-8")
    return path


def refused(folder: Path, text: str) -> str:
    with pytest.raises(InputError) as said:
        load_trial(written(folder, text))
    sentence = str(said.value)
    assert sentence.startswith(str(folder))
    assert "\n" not in sentence
    return sentence


def test_the_table_becomes_a_stream_with_the_own_defaults(tmp_path: Path) -> None:
    stream = require_stream(load_trial(written(tmp_path, SHIP + STREAM)))
    assert (stream.source, stream.name, stream.file) == (StreamSource.FILE, "log", tmp_path / "log.csv")
    assert (stream.rate, stream.batch_window_s) == (10.0, 3600.0)
    assert stream.forgetting_time_s is None
    assert (stream.host, stream.port, stream.page, stream.journal) == ("127.0.0.1", None, 0, None)
    delta = stream.layout.columns[1]
    assert (delta.source, delta.unit, delta.positive, stream.layout.format) == (3, "deg", "port", "text")


def test_a_followed_trial_needs_no_records_and_says_who_does(tmp_path: Path) -> None:
    assert load_trial(written(tmp_path, SHIP + STREAM)).runs == ()
    assert "[follow] for 'seatrial follow'" in refused(tmp_path, SHIP)


def test_runs_of_the_records_may_all_be_for_validation(tmp_path: Path) -> None:
    (tmp_path / "held_out.csv").write_text("t,r,delta\n0,0,0\n", encoding="utf-8")
    records = """[[records]]
files = "held_out.csv"
validate = "held_out"
time = { column = "t" }
channels.r = { column = "r", unit = "deg/s" }
"""
    assert [run.role for run in load_trial(written(tmp_path, SHIP + STREAM + records)).runs] == [Role.VALIDATE]
    assert "no run is left to train on" in refused(tmp_path, SHIP + records)


@pytest.mark.parametrize(
    ("was", "becomes", "says"),
    [
        ('source = "file"', 'source = "files"', "follow.source"),
        ('file = "log.csv"\n', "", "source = 'file' needs a file"),
        ('file = "log.csv"', "file = 3", "follow.file = 3: input should be a valid string"),
        ('source = "file"', 'source = "udp"', "source = 'udp' needs a port"),
        ("rate = 10\n", "", "key 'follow.rate' is missing"),
        ("rate = 10", "rate = 0", "follow.rate"),
        (
            "rate = 10",
            "rate = 10\njournl = 3",
            "unknown key 'follow.journl'; did you mean 'journal'?",
        ),
        ("rate = 10", "rate = 10\nport = 70000", "follow.port"),
        ("rate = 10", 'rate = 10\nhost = "no host"', "follow.host = 'no host' is no address"),
        ("rate = 10", 'rate = 10\nfiles = "*.csv"', "unknown key 'follow.files'; did you mean 'file'?"),
        ('unit = "deg/s"', 'unit = "deg"', "follow.channels.r.unit: 'deg' is no unit of yaw rate"),
        ('r = { column = "r"', 'rr = { column = "r"', "follow.channels.rr: unknown channel 'rr'"),
        ("column = 3", 'column = "r"', "column 'r' is named for 'r' and 'delta'"),
    ],
)
def test_what_cannot_be_is_refused_by_its_key(tmp_path: Path, was: str, becomes: str, says: str) -> None:
    assert was in STREAM
    assert says in refused(tmp_path, SHIP + STREAM.replace(was, becomes))


def test_a_sea_known_by_its_spectrum_alone_is_sent_to_identify(tmp_path: Path, repository: Path) -> None:
    text = (repository / "examples" / "heave_pitch_spectrum.toml").read_text(encoding="utf-8")
    stream_text = text.replace("[[records]]", '[follow]\nsource = "file"\nfile = "a.csv"\nrate = 5')
    stream_text = (
        stream_text.replace("records.", "follow.")
        .replace('files = "sea_unrecorded.csv"\n', "")
        .replace('kind = "simulated"\n', "")
    )
    assert "seatrial identify" in refused(tmp_path, stream_text.replace('source = "simulated"\n', ""))


def test_another_source_takes_the_same_columns(tmp_path: Path) -> None:
    trial = load_trial(written(tmp_path, SHIP + STREAM))
    moved = require_stream(with_source(trial, "stdin"))
    assert (moved.source, moved.name, moved.layout) == (StreamSource.STDIN, "stdin", require_stream(trial).layout)
    for feed, says in (("udp", "needs a port"), ("nmea-stdin", "other columns"), ("stdim", "did you mean 'stdin'?")):
        with pytest.raises(InputError, match=says.replace("?", r"\?")):
            with_source(trial, feed)


def test_a_trial_without_the_table_is_stated_to_add_it(repository: Path) -> None:
    with pytest.raises(InputError, match=r"waterjet\.toml: there is no \[follow\]"):
        require_stream(load_trial(repository / "examples" / "waterjet.toml"))
