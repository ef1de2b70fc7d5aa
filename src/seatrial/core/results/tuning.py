"""A tuned controller: what was asked, the front, the choice and its reasons, what simulation says. Plain values, SI."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from seatrial.core.values import Array, Finding, InputError, Record
from seatrial.numerics.optimise import Solution

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Complex = NDArray[np.complex128]


@dataclass(frozen=True)
class Component:
    """One block of the diagram: num(s) / den(s), highest power first; `role` is where it stands.

    role: ``sensor``, ``term``, ``filter``, ``servo``, ``plant``, ``disturbance``; `gain`: what multiplies a term.
    """

    role: str
    name: str
    num: tuple[float, ...]
    den: tuple[float, ...]
    gain: str = ""
    source: str = ""


@dataclass(frozen=True)
class ControllerConstraints:
    """What every controller must keep.

    Attributes:
        peak: largest Ms; saturation, rate_saturation: largest share of actuator amplitudes and rate amplitudes beyond
            the actuator's limits (Rayleigh).
        limit, rate, stall: of the actuator [rad, rad/s, rad]; infinite where there is none.
    """

    Ms: float = 2.0
    saturation: float = 0.2
    rate_saturation: float = 0.2
    limit: float = float("inf")
    rate: float = float("inf")
    stall: float = float("inf")


@dataclass(frozen=True, eq=False)
class Controller:
    """One set of gains and everything linear theory says of it in the seas of the task.

    Attributes:
        name: ``chosen``, ``given``, ``fitted baseline`` and the like.
        gains: name -> value; objectives: (m,) in the tuning's order.
        rms: of ``output``, ``actuator``, ``actuator_rate``, SI, mean square over the seas.
        reduction: of the output's rms against no control, 0 to 1; NaN where there is nothing to compare with.
        peak, gain_margin, phase_margin [rad], delay_margin [s], damping: Ms, factor, ..., least damping ratio.
        saturation, rate_saturation: worst of the seas, 0 to 1.
        broken: restrictions not kept, in words; empty if feasible.
        omega: rad/s, (n,); open_loop: L there, complex; the sensitivity is 1 / |1 + L|.
    """

    name: str
    gains: dict[str, float]
    objectives: Array
    rms: dict[str, float]
    reduction: float
    Ms: float
    gain_margin: float
    phase_margin: float
    delay_margin: float
    damping: float
    saturation: float
    rate_saturation: float
    violated: tuple[str, ...]
    omega: Array
    open_loop: Complex


@dataclass(frozen=True, eq=False)
class ParetoFront:
    """Controllers of which none is better than another in all objectives.

    Attributes:
        name: ``three gains`` and the like; gains: (n, g) in the order of `names`; objectives: (n, m); peak: (n,).
        evaluations: how many were made; hypervolume: of the front over that of a brute-force grid, NaN without one.
    """

    name: str
    gain_names: tuple[str, ...]
    gains: Array
    objectives: Array
    Ms: Array
    evaluations: int
    hypervolume: float = float("nan")


@dataclass(frozen=True, eq=False)
class SeawaySimulation:
    """One controller in nonlinear simulation over seeds; reductions of rms, 0 to 1, shape (seeds,).

    Attributes:
        linear: without limits; limited: with angle and rate limits; stalled: with stall, too.
        record: of the first seed, everything switched on; channels: output, actuator, disturbance, and the output of
            the same sea without control, its name with ``_uncontrolled``.
    """

    name: str
    linear: Array
    limited: Array
    stalled: Array
    record: Record

    @property
    def saturation_loss(self) -> float:
        """Reduction lost to angle and rate limits, mean over seeds."""
        return float(np.mean(self.linear - self.limited))


@dataclass(frozen=True)
class PairedDifference:
    """Reduction of the chosen controller minus that of another on the same seas: mean and 95 % interval."""

    baseline: str
    stage: str
    mean: float
    lower: float
    upper: float
    seeds: int


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """One condition of the schedule: U [m/s], beta [rad], height [m]; costs of its gains and of others there.

    A cost is the output's rms over that without control.
    """

    U: float
    beta: float
    height: float
    gains: dict[str, float]
    cost: float
    Ms: float
    saturation: float
    baseline_costs: dict[str, float]
    is_feasible: bool


@dataclass(frozen=True)
class PerformanceBound:
    """What no linear controller of its kind does better: output variance over that of the chosen one.

    `at`: what is held equal (actuator rate energy), the spectrum and the Ms; `note`: what it means.
    """

    name: str
    ratio: float
    conditions: str
    note: str


@dataclass(frozen=True, eq=False)
class ManoeuvreResponse:
    """One controller carried through a demand, nonlinear model and limits: a course or speed change, a zigzag.

    Attributes:
        record: demand and answer; overshoot: share of the change; settling: s to stay within 5 %, NaN if never.
        stable_draws, draws: ships drawn from the fit's covariance with a stable loop, and all.
        drawn: answers of some of them, each on the record's time, (k, n).
        worst_overshoot: over the ships drawn; NaN without draws.
    """

    name: str
    controller: str
    record: Record
    output: str
    overshoot: float
    settling: float
    stable_draws: int
    draws: int
    worst_overshoot: float
    sampled_outputs: Array


@dataclass(frozen=True, eq=False)
class Tuning:
    """A controller tuned.

    Attributes:
        plant: where it comes from, in words; seas: those it is tuned in, in words.
        output, actuator: symbols in the notation; objectives: names, units: of the objectives.
        chosen: the recommendation; reasons: why, sentence by sentence; rivals: given gains, other choices.
        front: with the task's own gains; richer: fronts of more structure or other comparisons.
        components: the chosen loop's blocks, so that other programs can rebuild it.
        amplitudes: how the plant was linearised, in words; empty for a linear one.
    """

    question: str
    name: str
    plant: str
    seas: tuple[str, ...]
    output: str
    actuator: str
    objectives: tuple[str, ...]
    units: tuple[str, ...]
    constraints: ControllerConstraints
    chosen: Controller
    reasons: tuple[str, ...]
    baselines: tuple[Controller, ...]
    front: ParetoFront
    extended_fronts: tuple[ParetoFront, ...]
    components: tuple[Component, ...]
    seaway_simulations: tuple[SeawaySimulation, ...]
    paired_differences: tuple[PairedDifference, ...]
    schedule: tuple[OperatingPoint, ...]
    bounds: tuple[PerformanceBound, ...]
    manoeuvres: tuple[ManoeuvreResponse, ...]
    findings: tuple[Finding, ...]
    solution: Solution
    seed: int
    elapsed_s: float
    versions: dict[str, str] = field(default_factory=dict)

    def plot(self) -> "Figure":
        """Draw the front with the controllers compared, or |S| and |T| where there is one objective, by Matplotlib.

        Raises:
            InputError: neither a front nor a loop is known.
        """
        from seatrial.core.figures.matplotlib_axes import matplotlib_figure
        from seatrial.core.results.front_chart import front_chart
        from seatrial.core.results.loop_charts import sensitivity_chart

        chart = front_chart(self) or sensitivity_chart(self)
        if chart is None:
            raise InputError(f"the tuning '{self.name}' has neither a front nor a stable loop to plot")
        return matplotlib_figure(chart)
