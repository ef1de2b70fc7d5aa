"""Everything the tables, figures and verdicts of the study rest on."""

from dataclasses import dataclass

import numpy as np

from seatrial.numerics.optimise import Normaliser
from seatrial.physics.loops.fin import Preamplifier
from seatrial_studies.yu2014.audit import Audit
from seatrial_studies.yu2014.better import Better, Richer
from seatrial_studies.yu2014.fitted import Fitted, best_of
from seatrial_studies.yu2014.histories import Histories
from seatrial_studies.yu2014.published import TABLE_1
from seatrial_studies.yu2014.readings import Fins, Motion, Sea, motion, performance
from seatrial_studies.yu2014.searches import Searches


@dataclass(frozen=True, eq=False)
class Evidence:
    """Numbers of one run of the study.

    Attributes:
        calibrated: K_q by reading; table_1: the GA's column at these, long-crested, by reading, in the table's order.
        fitted: table 1 fitted, each reading in both senses of the heading.
        variation: of the rms roll of one record of 1000 s, share.
        in_time: s one search takes with records in time, compiled and with scipy's lsim.
        elsewhere: for each row of table 1 the least that three gains can make of the larger of roll and fin-rate
            variance over the paper's, by reading.
        three: the best of three gains by reading, with Ms <= 2 and with the paper's own Ms.
    """

    audited: Audit
    calibrated: dict[Preamplifier, float]
    table_1: dict[Preamplifier, tuple[Motion, ...]]
    fitted: tuple[Fitted, ...]
    histories: Histories
    variation: float
    searched: tuple[Searches, ...]
    in_time: tuple[float, float]
    three: dict[Preamplifier, tuple[Better, Better]]
    elsewhere: dict[Preamplifier, tuple[float, ...]]
    richer: Richer

    def fit(self, reading: Preamplifier) -> Fitted:
        """In the sense of the heading with the smaller error."""
        return best_of(self.fitted, reading)

    @property
    def best_fit(self) -> Fitted:
        """Of both readings."""
        return min(self.fitted, key=lambda f: f.error)

    def of(self, reading: Preamplifier, fins: Fins = Fins.PRINTED, normaliser: Normaliser = Normaliser.MAX) -> Searches:
        """Searches of one setting."""
        wanted = (reading, fins, normaliser)
        return next(s for s in self.searched if (s.setting.reading, s.setting.fins, s.setting.normaliser) == wanted)

    @property
    def seconds(self) -> float:
        """Of one search with its front, median."""
        return float(np.median(np.concatenate([s.seconds for s in self.searched])))


def at_table_1(reading: Preamplifier) -> tuple[Motion, ...]:
    """The paper's gains at every row of table 1, long-crested."""
    return tuple(motion(performance(reading, Sea(row.speed, row.heading))) for row in TABLE_1)
