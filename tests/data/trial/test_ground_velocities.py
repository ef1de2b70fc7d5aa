"""A receiver's velocities in a model of u and v are named, unless the trial says that they are over ground."""

import pytest

from seatrial.core.equations import Model
from seatrial.data.trial.plausibility import ground_velocity_findings
from seatrial.data.trial.schema import ChannelColumn, RecordsTable
from seatrial.physics.models.abkowitz import abkowitz
from seatrial.physics.models.nomoto import nomoto
from seatrial.physics.sensors import Sensors, VelocityReference


def block(*symbols: str) -> RecordsTable:
    return RecordsTable(files="run.csv", channels={s: ChannelColumn(column=s, unit="1") for s in symbols})


def test_a_receivers_velocities_are_a_warning_with_the_edit() -> None:
    (finding,) = ground_velocity_findings(abkowitz(), None, [block("psi"), block("sog", "cog")])
    assert finding.code == "velocity-over-ground"
    assert 'velocity = "ground" under [sensors]' in finding.advice and "current" in finding.consequence


@pytest.mark.parametrize(
    ("model", "sensors", "symbols"),
    [
        (abkowitz(), Sensors(velocity=VelocityReference.GROUND), ("sog", "cog")),
        (nomoto(), None, ("sog", "cog")),
        (abkowitz(), Sensors(), ("u", "v")),
    ],
    ids=["stated", "without u and v", "through the water"],
)
def test_others_are_not(model: Model, sensors: Sensors | None, symbols: tuple[str, ...]) -> None:
    assert ground_velocity_findings(model, sensors, [block(*symbols)]) == ()
