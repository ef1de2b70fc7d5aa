"""Added masses left at zero are named, with values where the ship's form is known."""

import re

import pytest

from seatrial.core.values import Severity, Ship
from seatrial.data.trial.model_table import added_mass_findings
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.nomoto import nomoto

KVLCC2 = {"L": 320.0, "B": 58.0, "d": 20.8, "C_b": 0.8098}
"""m and 1: SIMMAN 2008, full scale."""


def test_added_masses_at_zero_are_a_warning() -> None:
    (finding,) = added_mass_findings(abkowitz(), Ship("tender", {"L": 6.2}))
    assert finding.severity is Severity.WARNING
    assert all(name in finding.text for name in ("X_udot", "Y_vdot", "N_rdot"))
    assert "[model.fixed]" in finding.advice and "B, d and C_b" in finding.advice


def test_the_advice_has_values_where_the_form_is_known() -> None:
    (finding,) = added_mass_findings(abkowitz(), Ship("KVLCC2", KVLCC2))
    values = {name: float(value) for name, value in re.findall(r"(\w+) = (-[\d.]+)", finding.advice)}
    prime = KVLCC2["d"] / KVLCC2["L"]  # from rho/2 L^2 d to rho/2 L^3
    assert values["Y_vdot"] == pytest.approx(-0.223 * prime, rel=0.04)  # m_y', Yasukawa & Yoshimura 2015, table 3
    assert values["N_rdot"] == pytest.approx(-0.011 * prime, rel=0.06)  # J_z', the same table


def test_one_that_is_given_or_free_is_enough() -> None:
    assert not added_mass_findings(abkowitz().with_values({"Y_vdot": -0.01}), Ship("tender", {"L": 6.2}))
    assert not added_mass_findings(abkowitz(["Y_v", "Y_vdot"]), Ship("tender", {"L": 6.2}))
    assert not added_mass_findings(nomoto(), Ship("tender", {"L": 6.2}))
