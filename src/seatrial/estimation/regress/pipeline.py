"""The pipeline of Song et al. 2025 as one estimator: clean, take the first block, select, regress what was selected.

Thresholds, penalty and tube are not printed there; those here are ours, and said on the study's page.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field

from seatrial.core.equations import Model
from seatrial.core.values import Finding, Record
from seatrial.estimation.regress.cleaning import without_duplicates, without_missing, without_outliers, without_small
from seatrial.estimation.regress.estimators import RegressionEstimate, solve_systems
from seatrial.estimation.regress.features import RegressionMotion
from seatrial.estimation.regress.operators import Centred, DerivativeOperator, Differenced, Euler
from seatrial.estimation.regress.solvers import Lasso, LinearSolver, RegressionSolution
from seatrial.estimation.regress.split import blocks
from seatrial.estimation.regress.support_vectors import SupportVectors
from seatrial.estimation.regress.system import RegressionSystem, build_systems

# section 1.4: differenced and centred
DIFFERENCED_AND_CENTRED = Centred(Differenced(Euler()))


@dataclass(frozen=True)
class Cleaning:
    """The four steps of section 1.2 over the model's states and inputs as far as the record holds them.

    Attributes:
        max_score: largest standard score that stays, eq. (5); constant channels have none.
        min_share: least absolute value that stays, eq. (8), of the states that are velocities, as a share of each one's
            standard deviation; 0 keeps all.
    """

    max_score: float = 3.0
    min_share: float = 1e-3

    def clean(self, model: Model, record: Record) -> Record:
        """What is left of a record.

        Raises:
            InputError: nothing would be left.
        """
        held = [s for s in (*model.states, *model.input_names) if s in record]
        known = without_missing(record, held)
        moving = [s for s in _velocities(model) if s in known and float(known[s].std()) > 0.0]
        kept = without_duplicates(without_outliers(known, self.max_score, moving), held)
        return without_small(kept, {s: self.min_share * float(known[s].std()) for s in moving})


@dataclass(frozen=True)
class Pipeline:
    """Cleaning, `training_share` of each record, Lasso's selection on Euler's rows, then an arithmetic on others.

    Attributes:
        selection: which coefficients stay; None keeps all.
        operator: rows that the coefficients are found from; the published improvement differences and centres them.
    """

    name: str = "published pipeline, improved (Song et al. 2025)"
    cleaning: Cleaning = field(default_factory=Cleaning)
    training_share: float = 0.8
    selection: Lasso | None = field(default_factory=Lasso)
    operator: DerivativeOperator = DIFFERENCED_AND_CENTRED
    solver: LinearSolver = field(default_factory=SupportVectors)

    def estimate(self, model: Model, records: Sequence[Record]) -> RegressionEstimate:
        """The coefficients; those that were not selected are zero.

        Raises:
            InputError: cleaning leaves nothing, or a training block is shorter than a manoeuvre.
        """
        cleaned = [self.cleaning.clean(model, record) for record in records]
        motions = [RegressionMotion.from_record(model, blocks(record, self.training_share)[0]) for record in cleaned]
        findings: list[Finding] = []
        kept = dict[tuple[str, ...], tuple[str, ...]]()
        for system in build_systems(model, motions, Euler()):
            kept[system.equations], said = self._select_coefficients(system)
            findings += said
        made = [
            s.restricted_to(kept[s.equations])
            for s in build_systems(model, motions, self.operator)
            if kept[s.equations]
        ]
        found = solve_systems(model, made, self.solver.solve)
        return RegressionEstimate(found.values, found.bias, (*findings, *found.findings), found.settings)

    def _select_coefficients(self, system: RegressionSystem) -> tuple[tuple[str, ...], tuple[Finding, ...]]:
        if self.selection is None:
            return system.names, ()
        solved: RegressionSolution = self.selection.solve(system)
        return tuple(n for n, c in zip(system.names, solved.coefficients, strict=True) if c != 0.0), solved.findings


def _velocities(model: Model) -> list[str]:
    """The states whose rates hold coefficients."""
    first = len(model.states) + len(model.inputs)
    free = {first + model.parameters.index(n) for n in model.parameters.free_names}
    holding = {int(state) for state, column in model.compiled.rates_pattern if int(column) in free}
    return [model.states[i] for i in sorted(holding)]
