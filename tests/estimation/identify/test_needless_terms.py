"""A term that leads away from the held-out run is named, and its removal is what a fit without it does."""

import re
from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest

from seatrial.core.results import Fit, Prediction
from seatrial.core.results.fit import Stability
from seatrial.core.values import Record, Ship
from seatrial.data.trial import EstimateSettings, Role, Run, Trial
from seatrial.estimation.estimate import Estimation
from seatrial.estimation.identify import assembled_fit, identify
from seatrial.estimation.identify.terms import needless_term_findings
from seatrial.physics.manoeuvres.programme import programme
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.simulate import manoeuvre


def zigzag(angle: int, alpha: float, rng: np.random.Generator) -> Record:
    """A boat of 6 m whose gain falls by alpha [s^2/rad^2], with the noise of its compass and gyro."""
    boat = nomoto().with_values({"K": 1.0, "T": 1.0, "alpha": alpha, "U": 4.0})
    run = manoeuvre(boat, programme(f"zigzag:{angle}/{angle}"), duration=60.0, slew_rate=0.2).renamed(f"{angle}")
    for name, deviation in (("psi", 0.005), ("r", 0.003)):  # rad, rad/s
        samples = run[name] + deviation * rng.standard_normal(len(run))
        run = run.with_channel(name, run.channel(name).with_values(samples))
    return run.without("x0", "y0")


def fitted(alpha: float, *free: str) -> Fit:
    """Three training runs, the gain of the largest falls with the rudder; the run held out has its own alpha."""
    rng = np.random.default_rng(3)
    trained = [zigzag(8, 0.0, rng), zigzag(12, 0.0, rng), zigzag(20, 3.0, rng)]
    runs = [*trained, replace(zigzag(25, alpha, rng), name="held")]
    roles = (*(Role.TRAIN for _ in trained), Role.VALIDATE)
    model = nomoto()
    model = model.with_parameters(model.parameters.only_free(("K", "T", *free)))
    timing = EstimateSettings(delays={"delta": 0.0})  # simulated: known
    return identify(Trial(Ship("boat", {"L": 6.0}), tuple(map(Run, runs, roles)), model, estimate=timing))


@pytest.fixture(scope="module")
def examined() -> tuple[Fit, Estimation, Sequence[Prediction]]:
    """The fit with a term too many, and what it was examined for such terms by."""
    examples = list[tuple[Estimation, Sequence[Prediction]]]()

    def noted(estimation: Estimation, predictions: Sequence[Prediction], course: Stability | None) -> tuple:
        assert course is None or not course.is_unstable
        examples.append((estimation, predictions))
        return needless_term_findings(estimation, predictions, course)

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(assembled_fit, "needless_term_findings", noted)
        return fitted(0.0, "alpha"), *examples[0]


def test_a_term_that_worsens_the_held_out_run_is_named_with_both_errors(
    examined: tuple[Fit, Estimation, Sequence[Prediction]],
) -> None:
    """The error without it is that of a fit without it, as far as one step goes."""
    fit = examined[0]
    (finding,) = [f for f in fit.findings if f.code == "term-worsens-prediction"]
    assert finding.message == "held would be predicted better with alpha at 0"
    with_it, without = (float(number) for number in re.findall(r"([\d.]+) deg", finding.evidence))
    assert with_it == pytest.approx(fit.validation[0].rms["psi_deg"], rel=0.05)
    assert without == pytest.approx(fitted(0.0).validation[0].rms["psi_deg"], rel=0.15)
    assert without < 0.5 * with_it
    assert finding.advice.startswith("do not fix it: the training runs determine it")


def test_nothing_is_said_of_a_craft_whose_runs_leave_any_model(
    examined: tuple[Fit, Estimation, Sequence[Prediction]],
) -> None:
    unstable = Stability(index=-1.0, lower=-2.0, upper=-0.5, text="")
    assert len(needless_term_findings(*examined[1:])) == 1
    assert needless_term_findings(*examined[1:], unstable) == ()


def test_a_term_that_the_held_out_run_needs_is_not_named() -> None:
    assert "term-worsens-prediction" not in [f.code for f in fitted(3.0, "alpha").findings]


def test_nothing_is_said_of_runs_whose_errors_the_disturbance_leaves(
    examined: tuple[Fit, Estimation, Sequence[Prediction]],
) -> None:
    _, estimation, predictions = examined
    carried = [replace(p, noise_floor=dict(p.rms)) for p in predictions]
    plain = replace(estimation, noise_model=replace(estimation.noise_model, method="output error"))
    assert needless_term_findings(estimation, carried) == ()
    assert len(needless_term_findings(plain, carried)) == 1  # output error: the floor holds errors of the model
