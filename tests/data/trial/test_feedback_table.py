"""`[feedback]`: what a declared controller orders, and declarations that the records do not allow."""

from pathlib import Path

import numpy as np
import pytest

from seatrial.core.values import InputError, Record
from seatrial.data.trial import ControllerGains, Feedback, load_trial
from seatrial.data.trial.craft_tables import refuse_unusable_feedback

TIME = 0.1 * np.arange(200)
RECORD = Record.from_arrays(
    "auto_1",
    TIME,
    {"delta": 0.0 * TIME, "psi": 0.1 * TIME, "r": 0.1 + 0.0 * TIME, "psi_ref": 2.0 * np.pi + 0.3 + 0.0 * TIME},
)
GAINS = ControllerGains(gain=2.0, rate_gain=3.0, integral_gain=0.5, sample_s=0.1)
DECLARED = Feedback(input="delta", output="psi", reference="psi_ref", controller=GAINS)


def test_a_controller_orders_by_its_law() -> None:
    """The error 0.3 - 0.1 t has the integral 0.3 t - 0.05 t^2; a whole turn of the reference counts as none."""
    record = RECORD.rows(slice(0, 60))
    error, integral = 0.3 - 0.1 * record.time, 0.3 * record.time - 0.05 * record.time**2
    order = DECLARED.order_of(record)
    assert order is not None
    np.testing.assert_allclose(order, 2.0 * error - 0.3 + 0.5 * integral, atol=1e-12)


def test_a_constant_reference_is_one_of_every_sample() -> None:
    declared = Feedback(input="delta", output="psi", reference=0.2, runs=("auto_*",))
    np.testing.assert_allclose(declared.reference_of(RECORD), np.full(len(TIME), 0.2))
    assert declared.order_of(RECORD) is None
    assert declared.reference_of(RECORD.renamed("zigzag")) is None


def test_a_declaration_that_fits_is_accepted() -> None:
    refuse_unusable_feedback(DECLARED, [RECORD])


def refused(declared: Feedback, record: Record = RECORD) -> str:
    with pytest.raises(InputError) as caught:
        refuse_unusable_feedback(declared, [record], "trial.toml: ")
    assert "\n" not in str(caught.value)
    return str(caught.value)


def test_a_reference_that_was_not_recorded_is_refused() -> None:
    channels = {n: RECORD[n] for n in ("delta", "psi", "r")}
    assert refused(DECLARED, Record.from_arrays("auto_1", TIME, channels)) == (
        "trial.toml: feedback.reference: record 'auto_1' has no channel 'psi_ref'; add psi_ref under "
        '[records.channels], or give a constant, reference = { value = 0, unit = "deg" }'
    )


def test_a_controller_with_another_sample_time_is_refused() -> None:
    slow = ControllerGains(gain=1.0, sample_s=0.5)
    assert refused(Feedback(input="delta", output="psi", reference=0.0, controller=slow)) == (
        "trial.toml: feedback.controller.sample_s is 0.5 s, but record 'auto_1' has a sample every 0.1 s; write "
        "rate = 2 under [estimate], or correct sample_s"
    )


def test_runs_that_nobody_recorded_are_refused() -> None:
    declared = Feedback(input="delta", output="psi", runs=("zigzag_*",))
    assert refused(declared) == "trial.toml: feedback.runs matches no training run; those are 'auto_1'"


def test_a_controller_needs_a_reference_and_a_rate() -> None:
    with pytest.raises(InputError, match="add the reference"):
        Feedback(input="delta", output="psi", controller=GAINS)
    with pytest.raises(InputError, match="no channel is the rate of 'u'"):
        Feedback(input="n", output="u", reference=1.0, controller=GAINS)


@pytest.mark.parametrize(
    ("table", "sentence"),
    [
        ('input = "rudder"\noutput = "psi"', "feedback.input: unknown name 'rudder'; write delta"),
        ('input = "delta"\noutput = "heading"', "feedback.output: unknown name 'heading'"),
        ('input = "delta"\noutput = "psi"\nreference = "psi_reff"', "did you mean 'psi_ref'?"),
        ('input = "delta"\noutput = "psi"\ngain = 1', "unknown key 'feedback.gain'"),
        ('input = "delta"\noutput = "psi"\nreference = { value = 1, unit = "kg" }', "no unit of 'psi'; write rad"),
        ('input = "delta"\noutput = "psi"\nreference = true', "feedback.reference"),
        ('input = "delta"', "key 'feedback.output' is missing"),
    ],
)
def test_what_the_file_gets_wrong_is_one_sentence(trial_file: Path, table: str, sentence: str) -> None:
    text = trial_file.read_text(encoding="utf-8").replace('"waterjet"', '"nomoto"')
    trial_file.write_text(f"{text}\n[feedback]\n{table}\n", encoding="utf-8")
    with pytest.raises(InputError) as caught:
        load_trial(trial_file)
    assert str(caught.value).startswith(str(trial_file))
    assert sentence in str(caught.value)


def test_a_constant_has_a_unit(trial_file: Path) -> None:
    text = trial_file.read_text(encoding="utf-8").replace('"waterjet"', '"nomoto"')
    more = '[feedback]\ninput = "delta"\noutput = "psi"\nreference = { value = 90, unit = "deg" }\nruns = "a_*"\n'
    trial_file.write_text(f"{text}\n{more}", encoding="utf-8")
    declared = load_trial(trial_file).feedback
    assert declared is not None
    reference = declared.reference_of(RECORD.renamed("a_1"))
    np.testing.assert_allclose(reference, np.full(len(TIME), 0.5 * np.pi))
    assert declared.runs == ("a_*",)
