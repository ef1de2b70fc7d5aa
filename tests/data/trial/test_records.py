"""From files to checked records: units, signs, roles; approach and release; what errors do; trimming."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import Finding, InputError, Record, RecordKind, Severity
from seatrial.data.check.phases import first_execution, is_free_decay
from seatrial.data.trial import (
    Role,
    Run,
    Trimming,
    checked_records,
    load_records,
    load_trial,
    refuse_errors,
    with_input_corners,
)
from seatrial.data.trial.records import (
    APPROACH_SECONDS,
    apply_trimming,
    approach_condition,
    load_parts,
    load_run,
    need_release,
    require_decay,
    trim_to_decay_start,
)
from seatrial.physics.models import model_named


def test_records_come_in_the_notation_tables_conventions(trial_file: Path) -> None:
    records, _ = load_records(load_trial(trial_file))
    first = records[0].record
    assert [r.role for r in records] == ["train", "train", "validate"]
    assert first["u"][0] == pytest.approx(1.6 * 1852 / 3600)
    assert first.channel("delta").positive == "starboard"
    assert first["delta"][0] == pytest.approx(np.radians(20.0))
    assert first.provenance.sha256


def test_records_may_be_declared_simulated(trial_file: Path) -> None:
    assert {r.record.kind for r in load_records(load_trial(trial_file))[0]} == {RecordKind.MEASURED}
    trial_file.write_text(trial_file.read_text().replace("[[records]]", '[[records]]\nkind = "simulated"', 1))
    assert RecordKind.SIMULATED in {r.record.kind for r in load_records(load_trial(trial_file))[0]}
    trial_file.write_text(trial_file.read_text().replace('"simulated"', '"planned"', 1))
    with pytest.raises(InputError, match="kind"):
        load_trial(trial_file)


def test_a_wrong_column_is_named(trial_file: Path) -> None:
    trial_file.write_text(trial_file.read_text().replace('"surge"', '"surges"'))
    with pytest.raises(InputError, match="surges"):
        load_records(load_trial(trial_file))


def test_errors_refuse_unless_accepted() -> None:
    error = Finding(Severity.ERROR, "wrong-sign", "run a: the rudder turns the other way", "r 3 deg/s", "set positive")
    with pytest.raises(InputError, match=r"rudder turns the other way.*set positive.*accept = \[\"wrong-sign\"\]"):
        refuse_errors((error,), ())
    assert refuse_errors((error,), ("wrong-sign",))[0].severity is Severity.WARNING


def test_a_validation_run_that_cannot_be_read_is_a_finding(trial_folder: Path) -> None:
    (trial_folder / "c_2024-05-02.csv").write_text("nothing\nof use\n")
    checked = checked_records(load_trial(trial_folder / "trial.toml"))
    assert [r.record.name for r in checked.records] == ["a_2024-05-01", "b_2024-05-02"]
    (finding,) = [f for f in checked.findings if f.code == "not-read"]
    assert finding.severity is Severity.WARNING
    assert "c_2024-05-02.csv: no column" in finding.message
    (trial_folder / "a_2024-05-01.csv").write_text("nothing\nof use\n")
    with pytest.raises(InputError, match="no column"):
        checked_records(load_trial(trial_folder / "trial.toml"))


def test_a_validation_run_that_fails_the_checks_is_not_predicted(trial_folder: Path) -> None:
    header, *rows = (trial_folder / "c_2024-05-02.csv").read_text().splitlines()
    turned = [",".join((*cells[:4], str(-float(cells[4])), cells[5])) for cells in (row.split(",") for row in rows)]
    (trial_folder / "c_2024-05-02.csv").write_text("\n".join([header, *turned]) + "\n")
    trial = load_trial(trial_folder / "trial.toml")
    errors = [f for f in load_records(trial)[1] if f.severity is Severity.ERROR]
    checked = checked_records(trial)
    assert errors
    assert {f.code for f in errors} <= {f.code for f in checked.findings}
    assert len(checked.records) == 2
    (finding,) = [f for f in checked.findings if f.code == "not-predicted"]
    assert finding.advice.count(f'"{errors[0].code}"') == 1
    accepted = replace(trial, accept=tuple(f.code for f in errors))
    assert len(checked_records(accepted).records) == 3


def test_noise_beyond_all_that_is_recorded_is_refused(trial_file: Path) -> None:
    trial_file.write_text(trial_file.read_text() + '\n[noise]\nr = { sd = 1e28, unit = "deg/s" }\n')
    with pytest.raises(InputError, match=r"\[noise\] r = .* is over 1000 times the largest value in the records"):
        load_records(load_trial(trial_file))


def _run_up() -> Record:
    time = np.arange(0.0, 60.0, 0.5)
    speed = np.minimum(time / 20.0, 1.0)
    return Record.from_arrays("run-up", time, {"u": speed, "delta": np.where(time > 40.0, 0.3, 0.0)})


def test_the_acceleration_run_is_dropped_on_request() -> None:
    assert apply_trimming(_run_up(), Trimming(skip_acceleration=True)).time[0] == pytest.approx(18.0)


def test_a_rate() -> None:
    assert apply_trimming(_run_up(), Trimming(rate=1.0)).dt == pytest.approx(1.0)


@pytest.mark.long(every=2)
@pytest.mark.parametrize(("example", "runs"), [("kvlcc2_hsva", 13), ("esso_osaka", 23)])
def test_the_ready_trial_files_pass_the_checks(
    example: str, runs: int, repository: Path, data_folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SEATRIAL_DATA", str(data_folder.resolve()))
    records, findings = load_records(load_trial(repository / "examples" / f"{example}.toml"))
    assert len(records) >= runs
    assert not [f for f in findings if f.severity is Severity.ERROR]


def test_a_long_hole_makes_two_runs_of_one_session() -> None:
    time = np.delete(np.arange(0.0, 600.0), np.arange(200, 300))
    psi = 0.5 * np.sin(2.0 * np.pi * time / 60.0)
    record = Record.from_arrays("log", time, {"psi": psi, "delta": 0.3 * np.cos(2.0 * np.pi * time / 60.0)})
    parts = load_parts(Run(record, Role.TRAIN, "day"), 0.0)
    assert [(part.record.name, len(part.record), part.session, part.run) for part in parts] == [
        ("log-1", 200, "day", "log"), ("log-2", 300, "day", "log"),
    ]  # fmt: skip
    assert load_run(Run(record, Role.TRAIN, "day"), 0.0).record.name == "log"


EXECUTE = 5.0  # s, when the rudder is put over


def run(speed: float) -> Record:
    """A straight run at `speed` [m/s] that slows down after the execute."""
    time = np.arange(0.0, 20.0, 0.1)
    after = time >= EXECUTE
    channels = {"u": np.where(after, 0.5 * speed, speed), "delta": np.where(after, 0.3, 0.0), "v_j": 1.8 + 0.0 * time}
    return Record.from_arrays("run", time, channels)


def test_the_execute_is_where_the_rudder_moves() -> None:
    assert run(1.0).time[first_execution(run(1.0))] == pytest.approx(EXECUTE)


def test_the_approach_is_the_median_over_records_of_what_comes_before() -> None:
    condition = approach_condition([run(speed) for speed in (1.0, 1.2, 9.0)], model_named("waterjet"))
    samples = 10 * APPROACH_SECONDS + 1  # of them the last one is the execute's own
    assert condition["u"] == pytest.approx(1.2 * (1.0 - 0.5 / samples))
    assert condition["v_j"] == pytest.approx(1.8) and "delta" not in condition


def test_a_ship_that_begins_from_rest_is_judged_by_its_run() -> None:
    """Course stability at a creeping speed would say nothing of the ship under way."""
    begun = run(1.0)
    begun = begun.with_channel("u", begun.channel("u").with_values(np.clip(0.3 * (begun.time - 4.0), 0.015, 1.0)))
    assert approach_condition([begun], model_named("waterjet"))["u"] == pytest.approx(1.0)


TIME = np.arange(0.0, 60.0, 0.05)


def decay(start: float = 0.15, noise: float = 0.0, damping: float = 0.03, rest: float = 0.002) -> Record:
    """Ten seconds at rest, heeled by hand, released at 15 s."""
    swing = np.where(TIME < 15.0, 0.0, np.exp(-damping * (TIME - 15.0)) * np.cos(2.5 * (TIME - 15.0)))
    held = np.where((TIME >= 10.0) & (TIME < 15.0), (TIME - 10.0) / 5.0, 0.0)
    phi = rest + start * (swing + held) + noise * np.random.default_rng(3).standard_normal(len(TIME))
    return Record.from_arrays("decay", TIME, {"phi": phi})


def test_what_lies_before_the_release_goes() -> None:
    """The largest angle stands at 15 s, to either side; the step says so."""
    for start in (0.15, -0.15):
        kept = trim_to_decay_start(decay(start, noise=1e-4))
        assert kept.time[0] == pytest.approx(15.0, abs=0.1)
        assert kept.time[-1] == TIME[-1]
        assert "from its release on" in kept.provenance.steps[-1]


def test_records_need_their_release_where_one_begins_before_it() -> None:
    from_release = trim_to_decay_start(decay())
    assert need_release([from_release, decay()]) and not need_release([from_release])
    assert not need_release([decay(), decay(damping=0.0)])


def test_an_angle_that_is_held_long_is_cut_at_the_release(rng: np.random.Generator) -> None:
    """Five seconds at one angle within the noise: the largest of them is any sample of the hold."""
    swing = np.where(TIME < 5.0, 1.0, np.exp(-0.03 * (TIME - 5.0)) * np.cos(2.5 * (TIME - 5.0)))
    phi = 0.2 * swing + 1e-3 * rng.standard_normal(len(TIME))
    record = Record.from_arrays("decay", TIME, {"phi": phi})
    kept = trim_to_decay_start(record)
    assert kept.time[0] == pytest.approx(5.0, abs=0.1)


@pytest.mark.parametrize(
    ("record", "said"),
    [
        (decay(start=0.001, noise=0.01), "within the noise"),
        (decay(damping=0.0), "does not decay: 8.7 deg in its first third, 8.7 deg in its last"),
        (
            Record.from_arrays("decay", TIME, {"phi": 0.002 * np.exp(0.07 * TIME) * np.cos(2.5 * TIME)}),
            "the roll grows, to 7.1 deg at 59",
        ),
        (decay(start=8.6), "the decay starts at 494.2 deg, beyond 90 deg; check the unit"),
        (Record.from_arrays("decay", TIME[:3], {"phi": np.zeros(3)}), "3 rows are no decay"),
        (decay().without("phi"), "needs a swing, 'phi'"),
        (Record.from_arrays("decay", TIME, {"phi": np.where(TIME > 59.8, 0.1, 0.0)}), "nothing is left of the decay"),
    ],
)
def test_what_is_no_decay_is_refused(record: Record, said: str) -> None:
    """One sentence, naming the record."""
    with pytest.raises(InputError, match=f"record 'decay'.*{said}"):
        trim_to_decay_start(record)


@pytest.mark.parametrize("channel", ["theta", "z"])
def test_a_decay_of_pitch_or_heave_begins_at_its_release(channel: str) -> None:
    held = np.where(TIME < 5.0, 1.0, np.exp(-0.3 * (TIME - 5.0)) * np.cos(2.5 * (TIME - 5.0)))
    still = 1e-4 * np.cos(7.0 * TIME)
    record = Record.from_arrays("decay", TIME, {**dict.fromkeys(("theta", "z"), still), channel: 0.05 * held})
    assert is_free_decay(record)
    assert need_release([record])
    assert trim_to_decay_start(record).time[0] == pytest.approx(5.0, abs=0.15)


@pytest.mark.parametrize("growth", [0.0, 0.01])
def test_a_motion_that_lasts_is_no_decay(growth: float) -> None:
    """Constant or growing amplitude, whether or not a release was sought; a decay passes."""
    lasting = Record.from_arrays("run", TIME, {"phi": 0.1 * np.exp(growth * TIME) * np.cos(2.5 * TIME)})
    with pytest.raises(InputError, match="record 'run': the roll does not decay"):
        require_decay(lasting)
    require_decay(trim_to_decay_start(decay()))


def test_a_decay_that_people_swung_up_begins_at_their_last_swing() -> None:
    size = np.where(TIME < 30.0, 0.2 + 0.8 * TIME / 30.0, np.exp(-0.1 * (TIME - 30.0)))
    phi = 0.18 * size * np.cos(2.5 * (TIME - 30.0))
    record = Record.from_arrays("decay", TIME, {"phi": phi})
    assert need_release([record])
    assert trim_to_decay_start(record).time[0] == pytest.approx(30.0, abs=0.1)


def test_a_ramp_within_a_sample_keeps_its_area_unless_its_course_is_declared() -> None:
    """A rudder that slews by 2 deg/s and turns 0.4 s behind samples, at 1 Hz: straight lines miss 0.24 deg s."""
    time, fine = np.arange(101.0), np.linspace(0.0, 16.0, 1601)
    times, angles = (
        [0.0, 13.4, 18.4, 33.4, 38.4, 53.4, 63.4, 78.4, 83.4, 100.0],
        [0, 0, 10, 10, 0, 0, -20, -20, -10, -10],
    )
    record = Record.from_arrays("run", time, {"delta": np.radians(np.interp(time, times, angles))})
    area = np.trapezoid(np.radians(np.interp(fine, times, angles)), fine)  # about the first corner
    model, straight = model_named("nomoto"), record.channel("delta")
    missed, remaining = (
        abs(np.trapezoid(values[:17], time[:17]) - area)
        for values in (straight.values, with_input_corners(record, model)["delta"])
    )
    assert missed > np.radians(0.2) and remaining < 0.1 * missed
    declared = record.with_channel("delta", replace(straight, between="straight"))
    assert with_input_corners(declared, model)["delta"] is declared["delta"]
