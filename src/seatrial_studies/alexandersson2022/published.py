"""What is published: the paper's numbers, what its code gives when run again, and the measured turning circles."""

from dataclasses import dataclass

SOURCE = (
    "Alexandersson, Mao & Ringsberg 2022, System identification of vessel manoeuvring models, "
    "Ocean Engineering 266, 112940, doi 10.1016/j.oceaneng.2022.112940"
)
# m, length of the KVLCC2 model
LENGTH = 7.0
SIDES = ("port", "starboard")


@dataclass(frozen=True)
class Turn:
    """Advance and tactical diameter of a 35 deg turn in ship lengths; an empty `side` means it is not stated."""

    side: str
    advance: float
    diameter: float
    source: str


# table tab_kvlcc2_advance in docs/paper/06.20_results_kvlcc2.ipynb of the authors' repository
# martinlarsalbert/System-identification-of-Vessel-Manoeuvring-Models
_TABLE = "MARIN, free-running test for SIMMAN 2008, in the paper's table"
# metres at the model's length of 7 m; rudder +35 deg of the table is to port, -35 deg to starboard
MEASURED_TURNS = {
    "port": Turn("port", 21.59 / LENGTH, 21.72 / LENGTH, _TABLE),
    "starboard": Turn("starboard", 22.54 / LENGTH, 23.55 / LENGTH, _TABLE),
}
# metres at full scale, length 320 m; quoted by others, the side is not stated
OTHER_TURNS = (Turn("", 982.0 / 320.0, 1049.0 / 320.0, "Quadvlieg & Brouwer 2011, MARIN, at second hand"),)
PREDICTED_TURNS = {
    "port": Turn("port", 21.21 / LENGTH, 23.07 / LENGTH, "the paper's prediction"),
    "starboard": Turn("starboard", 22.10 / LENGTH, 24.29 / LENGTH, "the paper's prediction"),
}
# in per cent: the published code (vessel-manoeuvring-models 0.0.6) run again on the same records
RERUN_ADVANCE = {"port": -0.9, "starboard": -1.6}
RERUN_DIAMETER = {"port": 6.1, "starboard": 3.0}
# the same: lower and upper value over its variants, open loop from rudder and propeller rate
RERUN_HEADING = (11.2, 11.7)
RERUN_POSITION = (10.0, 10.4)
# s of computing time, the same code
RERUN_SECONDS = 184.0


def percent_deviation(value: float, reference: float) -> float:
    """Return the deviation of `value` from `reference` in per cent."""
    return 100.0 * (value / reference - 1.0)


def published_range(measure: str) -> tuple[float, float]:
    """Smallest and largest measured value over sides and sources, widened by the paper's largest own error.

    measure: ``advance`` or ``diameter``.
    """
    values = [float(getattr(turn, measure)) for turn in (*MEASURED_TURNS.values(), *OTHER_TURNS)]
    worst = max(
        abs(percent_deviation(float(getattr(PREDICTED_TURNS[s], measure)), float(getattr(MEASURED_TURNS[s], measure))))
        for s in SIDES
    )
    return min(values) * (1.0 - worst / 100.0), max(values) * (1.0 + worst / 100.0)
