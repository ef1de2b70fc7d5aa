"""Copies of a record among the training runs: the fit is that of the distinct runs, and a finding says so."""

from dataclasses import replace

import numpy as np
from tests.estimation.predict.test_open_loop import GENTLE, run

from seatrial.core.values import Ship
from seatrial.data.trial import Role, Run, Trial
from seatrial.estimation.identify import identify
from seatrial.physics.models.nomoto import nomoto


def test_three_copies_leave_the_standard_errors_as_they_are(rng: np.random.Generator) -> None:
    runs = [run(name, GENTLE, rng, phase) for name, phase in (("a", 0.0), ("b", 7.0), ("v", 3.0))]
    trial = Trial(
        Ship("craft", {"L": 8.0}),
        (*(Run(r, Role.TRAIN) for r in runs[:2]), Run(runs[2], Role.VALIDATE)),
        nomoto(),
    )
    again = [Run(replace(r, name=f"{r.name} again {k}"), Role.TRAIN) for r in runs[:2] for k in (1, 2)]
    fitted = Run(replace(runs[0], name="not new"), Role.VALIDATE)
    once, thrice = identify(trial), identify(replace(trial, runs=(*trial.runs, *again, fitted)))
    assert [c.standard_error for c in thrice.coefficients] == [c.standard_error for c in once.coefficients]
    assert [c.estimate for c in thrice.coefficients] == [c.estimate for c in once.coefficients]
    copied = [f.text for f in thrice.findings if f.code == "copied-run"]
    assert len(copied) == 5
    assert sum("counts once" in text for text in copied) == 4
    assert any("'not new' is a copy of 'a'" in text and "fitted run" in text for text in copied)
    assert not [f for f in once.findings if f.code == "copied-run"]
