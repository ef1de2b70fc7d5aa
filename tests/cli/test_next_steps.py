"""The last line of a command names what to type next."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np
from tests.reporting.fabricated import fabricated_fit
from tests.reporting.fabricated_design import fabricated_design

from seatrial.cli.next_steps import after_campaign, after_check, after_design, after_fit
from seatrial.core.results import Divergence
from seatrial.core.results.campaign import CampaignStatus
from seatrial.core.values import Finding, Record, Severity, TrialEdit
from seatrial.physics.models import heave_pitch, roll
from seatrial.physics.models.thruster_layout import CATAMARAN, AngleInput, ThrusterLayout
from seatrial.physics.models.thrusters import thrusters

TRIAL, OUT = Path("my trial.toml"), Path("results")


def test_after_a_check_errors_come_first() -> None:
    error = Finding(Severity.ERROR, "unit", "wrong unit", advice="state the unit")
    model = Finding(Severity.INFO, "model", "no model", advice="name one in [model]")
    assert after_check((), TRIAL) == "seatrial identify 'my trial.toml' --out results"
    assert after_check((model,), TRIAL) == "identify cannot start yet: name one in [model]"
    assert after_check((model, error), TRIAL) == "state the unit"
    corrected = replace(error, edits=(TrialEdit("channels.u.unit", '"kn"'),))
    assert after_check((model, corrected), TRIAL) == "seatrial check 'my trial.toml' --fix"


def test_after_a_fit_a_run_is_held_out_or_a_manoeuvre_simulated() -> None:
    fit = fabricated_fit()
    circle = "seatrial simulate results/model.toml --manoeuvre turning-circle:30 --out circle.csv"
    assert after_fit(fit, OUT) == circle  # as far as the rudder went in the runs that were fitted
    first = replace(fit.coefficients[0], lower=-1.0, upper=1.0, fixed=False)
    undecided = replace(fit, coefficients=(first,))
    assert after_fit(undecided, OUT, TRIAL) == (
        f"{circle}; for a manoeuvre that determines {first.name}: seatrial design 'my trial.toml' --from "
        "results/model.toml --out plan"
    )
    trained = replace(fit, predictions=tuple(replace(p, role="training") for p in fit.predictions))
    assert after_fit(trained, OUT, TRIAL).startswith("name a run to hold out in 'my trial.toml'")


def test_after_a_fit_of_a_craft_with_thrusters_it_turns_as_it_can() -> None:
    fit, port = fabricated_fit(), CATAMARAN.thrusters[0]
    turned = replace(port, y=0.0, same_as="", angle=AngleInput("alpha_1"))
    run = Record.from_arrays("run", np.arange(50.0), {"alpha_1": np.full(50, math.radians(-22.0))})
    runs = tuple(replace(fit.predictions[0], measured=run, role=role) for role in ("training", "validation"))
    commands = [
        after_fit(replace(fit, model=thrusters(ThrusterLayout(of_craft)), predictions=runs), OUT)
        for of_craft in ((turned,), CATAMARAN.thrusters, (replace(turned, angle=0.0),))
    ]
    assert [command.split("--manoeuvre ")[1] for command in commands] == [
        "turning-circle:22 --out circle.csv", "spin:50 --out spin.csv", "straight:50 --out straight.csv",
    ]  # fmt: skip


def test_after_a_fit_that_misses_the_page_on_bad_fits_is_named() -> None:
    fit = fabricated_fit()
    missed = tuple(replace(p, divergence=Divergence(70.0, 65.0, "r")) for p in fit.predictions)
    assert after_fit(replace(fit, predictions=missed), OUT, TRIAL).startswith("docs/bad-fit.md, By symptom: ")


def test_after_a_fit_of_decays_a_release_is_simulated(rng: np.random.Generator) -> None:
    fit = fabricated_fit()
    time = 0.1 * np.arange(50)
    decay = Record.from_arrays("decay", time, {"phi": 0.2207 * np.cos(time) + 1e-6 * rng.standard_normal(50)})
    runs = tuple(replace(fit.predictions[0], measured=decay, role=role) for role in ("training", "validation"))
    assert after_fit(replace(fit, model=roll(), predictions=runs), OUT, TRIAL) == (
        "seatrial simulate results/model.toml --manoeuvre release:12 --out release.csv"
    )


def test_after_a_fit_of_spectra_which_predicts_no_run_its_report_is_named() -> None:
    spectral = replace(fabricated_fit(), model=heave_pitch(), predictions=())
    assert after_fit(spectral, OUT, TRIAL) == "seatrial report results"


def test_after_a_design_its_orders_a_standard_manoeuvre_or_nothing_is_carried_out() -> None:
    design = fabricated_design()
    best = design.baselines[1]  # random steps; its worst error is below one

    def erring(factor: float) -> str:
        errors = factor * best.relative_error
        return after_design(replace(design, designed=replace(design.designed, relative_error=errors)))

    log = "then seatrial init LOG --out trial.toml with the log of it"
    assert best.worst < 1.0
    assert erring(0.5) == f"carry out orders.csv, {log}"
    assert erring(2.0) == f"carry out the prbs 35 10, as the orders designed are no better, {log}"
    hopeless = replace(best, relative_error=np.full(11, 12.0))
    alone = replace(design, baselines=(hopeless,), designed=replace(design.designed, relative_error=np.full(11, 13.0)))
    assert after_design(alone).startswith("none of these manoeuvres determines X_uu, X_vv, X_rr ...: fix them")
    better = replace(alone, designed=replace(design.designed, relative_error=np.full(11, 11.0)))
    assert after_design(better) == f"carry out orders.csv, {log}"
    unmoved = replace(alone, baselines=(), designed=replace(design.designed, relative_error=np.full(11, math.inf)))
    assert after_design(unmoved).startswith("none of these")


def test_after_a_campaign_it_goes_on_is_tried_again_or_gathered() -> None:
    assert "goes on" in after_campaign(CampaignStatus(10, 4, 1, None), OUT)
    assert after_campaign(CampaignStatus(10, 9, 1, None), OUT) == "seatrial campaign retry results"
    assert after_campaign(CampaignStatus(10, 10, 0, None), OUT).startswith("seatrial campaign gather results --to")
