"""What the records determine of a fitted model and what they do not, put together for the report."""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Consequence, Identifiability, Sensitivity, Stability, Symmetry
from seatrial.core.results.fit import COURSE_UNSTABLE
from seatrial.core.text.numbers import significant
from seatrial.core.values import Array, Finding, InputError, Severity
from seatrial.data.trial import Trial
from seatrial.data.trial.model_table import COMMON_PARTICULARS
from seatrial.estimation.estimate.fit import Estimation
from seatrial.estimation.identify.score_test import assumed_information, output_error_estimate
from seatrial.estimation.information.covariance import (
    collinearity,
    condition_number,
    consequence_text,
    directions,
    effective_parameters,
    relative_information,
)
from seatrial.estimation.information.generator import join_names
from seatrial.estimation.information.stability import growth_rate, stability
from seatrial.estimation.problem.output_error import OutputError
from seatrial.physics.hydro.excitation import BoxHull
from seatrial.physics.models.published import HEAVE_PITCH_COEFFICIENTS, HEAVE_PITCH_STIFFNESSES

if TYPE_CHECKING:
    from seatrial.physics.simulate.thrust import StraightRun

# What the stated stiffness of a box hull decides: its wave forces grow with it, and so does every coefficient.

_OWN_INERTIA = {"a33": "m", "a55": "I5"}
_LIFTS = ("lift_1", "lift_2")


def stands_on_box(trial: Trial) -> bool:
    """Return whether wave forces of the trial are those of a box with the stated stiffness."""
    return any(run.waves is not None and isinstance(run.waves.excitation, BoxHull) for run in trial.runs)


@dataclass(frozen=True)
class BoxScale:
    """One factor of stiffness and wave forces.

    Attributes:
        stiffness: stated values other than zero.
        resisting: what is as large as these forces too: masses, dampings, lifts; held: those of them that are fixed.
    """

    stiffness: tuple[str, ...]
    resisting: tuple[str, ...]
    held: tuple[str, ...]

    def changes(
        self, changes: Mapping[str, Array], place: Mapping[str, int], values: Array, step: float
    ) -> dict[str, Array]:
        """Return assumed changes with one of the stiffness, and the forces with it, for those of each stiffness.

        changes: name -> (n,); place: parameter -> position in `values`, (n,); step: relative.
        """
        together = np.zeros(len(values))
        for name in self.resisting:
            together[place[name]] = -step * values[place[name]]
        rest = {name: change for name, change in changes.items() if name not in self.stiffness}
        return {f"{join_names(self.stiffness)} with the forces of the box": together, **rest}

    def symmetry(self, model: Model, outputs: tuple[str, ...]) -> Symmetry | None:
        """Return what no record can show where waves alone move the craft; None where fins of known lift do too."""
        if any(model.parameters[name].free or model.parameters[name].value for name in _LIFTS):
            return None
        change = dict.fromkeys(self.stiffness, 1.0)
        for name in (n for n in self.resisting if n in HEAVE_PITCH_COEFFICIENTS):
            own = model.parameters[_OWN_INERTIA[name]].value if name in _OWN_INERTIA else 0.0
            value = model.parameters[name].value
            change[name] = 1.0 + own / value if value else 1.0
        sums = (f"{own} + {name}" for name, own in _OWN_INERTIA.items() if name in change)
        alone = [n for n in self.resisting if n in HEAVE_PITCH_COEFFICIENTS and n not in _OWN_INERTIA]
        text = (
            f"{join_names([*self.stiffness, *sums, *alone])} can all be scaled by one factor, and the wave forces "
            f"of the box with them, without any change of {join_names(outputs, 'or')}. The stated stiffness sets the "
            "size of every coefficient; state it from the hydrostatics of the hull"
        )
        return Symmetry(tuple(change), text, change)


def box_scale(model: Model) -> BoxScale | None:
    """Return the factor of a model of heave and pitch whose stiffness is stated; None where it is estimated."""
    parameters = model.parameters
    if not {*HEAVE_PITCH_STIFFNESSES, *HEAVE_PITCH_COEFFICIENTS, "m", "I5"} <= {p.name for p in parameters}:
        return None
    if any(parameters[name].free for name in HEAVE_PITCH_STIFFNESSES):
        return None
    resisting = (*HEAVE_PITCH_COEFFICIENTS, "m", "I5", *(n for n in _LIFTS if n in {p.name for p in parameters}))
    resisting = tuple(n for n in resisting if parameters[n].free or parameters[n].value)
    stiffness = tuple(n for n in HEAVE_PITCH_STIFFNESSES if parameters[n].value)
    return BoxScale(stiffness, resisting, tuple(n for n in resisting if not parameters[n].free))


# Whether a craft holds a straight course by itself: a ship at its approach, a craft with thrusters at equal orders.

_SPEED_STEP = 1e-3  # m/s, to which the speed is found from which on a craft is unstable; chosen


def course_stability(
    model: Model, covariance: Array, degrees_of_freedom: float, approach: Mapping[str, float], length: float,
    ahead: float | None = None, fastest: float = math.inf,
) -> Stability | None:  # fmt: skip
    """Return the stability of the straight course; None without a yaw rate, or a speed ahead that counts.

    Args:
        covariance: of the free coefficients, (n, n).
        approach: steady speed u [m/s] and inputs of the trials, SI, notation signs; length: m.
        ahead: of a craft with thrusters, share of full command at which it runs, None: as programmes; its speed
            follows from that.
        fastest: of a craft with thrusters, speed [m/s] up to which it is judged, too; without it at `ahead` only.
    """

    def judged(run: "StraightRun") -> Stability | None:
        return stability(model, covariance, degrees_of_freedom, run.speed, run.inputs, length)

    if model.has_thrusters:
        from seatrial.physics.simulate.thrust import DEFAULT_AHEAD, straight_at_speed, straight_by_thrusters

        try:
            run = straight_by_thrusters(model, DEFAULT_AHEAD if ahead is None else ahead, approach)
            top = straight_at_speed(model, fastest, approach) if math.isfinite(fastest) else run
            slow = top if top.speed < run.speed else run
            return _over_speeds(model, approach, judged(slow), judged(top))
        except InputError:  # it has no steady speed ahead
            return None
    speed = approach.get("u", 0.0)
    if speed <= 0.0 and model.has_speed:
        return None
    inputs = np.array(
        [
            0.0 if i.name == "delta" else (-1.0 if i.is_reversed else 1.0) * approach.get(i.name, 0.0)
            for i in model.inputs
        ]
    )
    return stability(model, covariance, degrees_of_freedom, speed if speed > 0.0 else None, inputs, length)


def _over_speeds(
    model: Model, approach: Mapping[str, float], slow: Stability | None, fast: Stability | None
) -> Stability | None:
    """The stability at the faster of two speeds where the craft is unstable there, else at the slower."""
    from scipy.optimize import brentq

    from seatrial.physics.simulate.thrust import straight_at_speed

    if slow is None or fast is None or slow.speed == fast.speed:
        return slow
    assert slow.speed is not None and slow.growth_rate is not None
    assert fast.speed is not None and fast.growth_rate is not None
    top = f"{significant(fast.speed, 2)} m/s, the fastest of the training runs"
    if fast.growth_rate <= 0.0:
        if slow.is_stable and fast.is_stable:
            return replace(slow, text=f"{slow.text}; and so it is up to {top}")
        known = "it is course stable" if fast.is_stable else "that cannot be determined"
        return replace(slow, text=f"{slow.text}; at {top}, {known}")
    if slow.growth_rate >= 0.0:
        return replace(fast, text=f"{fast.text}; so it is at {significant(slow.speed, 2)} m/s")

    def growth(speed: float) -> float:
        run = straight_at_speed(model, speed, approach)
        return growth_rate(model, run.speed, run.inputs)

    limit = float(brentq(growth, slow.speed, fast.speed, xtol=_SPEED_STEP))
    text = f"{fast.text}; below about {significant(limit, 2)} m/s it is course stable"
    return replace(fast, text=text, stable_below=limit)


def course_finding(model: Model, course: Stability | None, approach: Mapping[str, float]) -> tuple[Finding, ...]:
    """Return a note `course-unstable` where a deviation grows beyond doubt; else nothing."""
    if course is None or not course.is_unstable:
        return ()
    return (Finding(
        Severity.INFO, COURSE_UNSTABLE, course.text,
        _index_text(course)
        + _turn_text(model, approach, course.speed),
    ),)  # fmt: skip


def _index_text(course: Stability) -> str:
    """The index C; without the speed that makes it a number, the growth rate."""
    if course.speed is not None or course.growth_rate is None:
        return f"C = {significant(course.index, 2)} [{significant(course.lower, 2)}, {significant(course.upper, 2)}]"
    low, high = (significant(end or 0.0, 2) for end in (course.growth_lower, course.growth_upper))
    return f"growth rate {significant(course.growth_rate, 2)} 1/s [{low}, {high}]"


def _turn_text(model: Model, approach: Mapping[str, float], speed: float | None) -> str:
    """The turn in which a craft with thrusters ends at equal orders; empty for others."""
    if not model.has_thrusters or speed is None:
        return ""
    from seatrial.physics.simulate.thrust import settled_yaw_rate, straight_at_speed

    try:
        turn = abs(math.degrees(settled_yaw_rate(model, straight_at_speed(model, speed, approach))))
    except InputError:  # the simulation diverges
        return ""
    return f"; at equal orders it ends in a turn of {significant(turn, 2)} deg/s"


# change of a value whose consequences are shown, ours
RELATIVE_CHANGE = 0.1
# shown in a report, ours
_MAX_CONSEQUENCES = 8
_ASSUMED_PARTICULARS = ("I_z", "x_G")
# what defines the coefficients, chosen with the equations: nothing that could be wrong
_CONVENTIONS = ("prime", "U_n", "U_0")
# information of a value over the largest that counts as none, ours
_MIN_INFLUENCE = 1e-9


def identifiability(
    estimation: Estimation,
    symmetries: Sequence[Symmetry],
    approach: Mapping[str, float],
    length: float,
    is_on_box: bool = False,
    fastest: float = math.inf,
) -> Identifiability:
    """Return everything a report shows about identifiability.

    symmetries: found before the fit; approach: steady speed u and inputs of the trials, SI, notation signs; length: m;
    is_on_box: whether the wave forces are those of a box with the stated stiffness; fastest: of the training runs, m/s.
    """
    problem = estimation.estimate.problem
    names, sizes = problem.free, _signed_scales(estimation)
    data, precision = data_information(estimation)
    scaled = relative_information(data, sizes)
    covariance = estimation.interval.covariance[: len(names), : len(names)]
    along = directions(data, names, sizes, precision, covariance)
    return Identifiability(
        structural=tuple(symmetries),
        directions=along,
        effective_parameters=effective_parameters(scaled, relative_information(precision, sizes), along),
        condition=condition_number(data),
        collinearity=collinearity(data, names),
        sensitivities=sensitivities(estimation),
        consequences=consequences(estimation, is_on_box),
        stability=course_stability(
            estimation.model, covariance, estimation.interval.degrees_of_freedom, approach, length, fastest=fastest
        ),
    )  # fmt: skip


def _signed_scales(estimation: Estimation) -> Array:
    """Sizes of the free coefficients at their estimates, with their signs: changes over them are relative changes."""
    parameters = [estimation.model.parameters[n] for n in estimation.estimate.problem.free]
    return np.array([np.copysign(p.characteristic_scale, p.value) for p in parameters])


def data_information(estimation: Estimation) -> tuple[Array, Array]:
    """Information of the records on the free coefficients, and that of priors and force points, both (n, n).

    Everything else (initial states, offsets with their own priors) is eliminated at its optimum.
    """
    problem = estimation.estimate.problem
    count, hessian = len(problem.free), estimation.information.copy()
    known = problem.prior_precision(estimation.estimate.common_parameters)
    hessian[:count, :count] -= known[:count, :count]
    return _eliminate_nuisances(hessian, count), known[:count, :count]


def _eliminate_nuisances(hessian: Array, count: int) -> Array:
    if len(hessian) == count:
        return hessian
    cross = hessian[:count, count:]
    return hessian[:count, :count] - cross @ np.linalg.solve(hessian[count:, count:], cross.T)


def sensitivities(estimation: Estimation) -> tuple[Sensitivity, ...]:
    """What a change of 10 % of each coefficient does to each output, initial states held."""
    estimate = output_error_estimate(estimation)
    problem = estimate.problem
    slopes = (
        problem.sensitivities(estimate.common_parameters, estimate.optimum.local)
        * RELATIVE_CHANGE
        * np.abs(_signed_scales(estimation))
    )
    total = np.sqrt(np.sum(slopes**2, axis=0))
    outputs = problem.data.outputs
    return tuple(
        Sensitivity(name, float(total[j]), {o: float(slopes[i, j]) for i, o in enumerate(outputs)})
        for j, name in enumerate(problem.free)
    )


def consequences(estimation: Estimation, is_on_box: bool = False) -> tuple[Consequence, ...]:
    """What the estimates would do were an assumed value 10 % off, by one Gauss-Newton step; the worst first.

    is_on_box: whether the wave forces are those of a box, which change with the stated stiffness.
    """
    problem, model = output_error_estimate(estimation).problem, estimation.model
    scaled_by_box = box_scale(model) if is_on_box else None
    free, names = problem.free, _assumed_names(problem, model)
    known = assumed_information(estimation, names, scaled_by_box.held if scaled_by_box else ())
    deviation = np.maximum(estimation.interval.standard_error[: len(free)], 1e-300)  # above zero, for a division
    sizes, fitted = _signed_scales(estimation), known.moving[: len(free)]
    felt = _MIN_INFLUENCE * np.max(np.diag(known.information)[fitted] * sizes**2)
    ranked: list[tuple[float, Consequence]] = []
    changes = {n: known.unit(n) * RELATIVE_CHANGE * model.parameters[n].value for n in names}
    if scaled_by_box:
        final = _with_final_values(known.point, known.place, model, free)
        changes = scaled_by_box.changes(changes, known.place, final, RELATIVE_CHANGE)
    for name, change in changes.items():
        if change @ known.information @ change < felt * RELATIVE_CHANGE**2:
            continue
        moves, misfit = known.shifts(change)
        worst = float(np.max(np.abs(moves) / deviation))
        ranked.append((worst, _consequence(name, moves / sizes, free, misfit, known.chi_squared)))
    ranked.sort(key=lambda pair: -pair[0])
    return tuple(one for _, one in ranked[:_MAX_CONSEQUENCES])


def _with_final_values(values: Array, place: Mapping[str, int], model: Model, free: Sequence[str]) -> Array:
    """The values with the free coefficients of the fit, over which relative changes are taken."""
    final = values.copy()
    for name in free:
        final[place[name]] = model.parameters[name].value
    return final


def _assumed_names(problem: OutputError, model: Model) -> list[str]:
    """Fixed parameters that were assumed: no conventions, no dimensions, and not zero."""
    own = {n for n, _ in problem.session_parameters}
    known = {*_CONVENTIONS, *own, *(n for n in COMMON_PARTICULARS if n not in _ASSUMED_PARTICULARS)}
    if problem.extra_terms:  # measured forces may have been corrected with it
        known.add("x_G")
    return [p.name for p in model.parameters if not p.free and p.value and p.name not in known]


def _consequence(
    name: str, estimate_changes: Array, free: Sequence[str], misfit: float, chi_squared: float
) -> Consequence:
    order = np.argsort(-np.abs(estimate_changes), kind="stable")
    ranked = {free[int(i)]: float(estimate_changes[i]) for i in order}
    return Consequence(
        name, RELATIVE_CHANGE, ranked, misfit, consequence_text(name, RELATIVE_CHANGE, ranked, misfit, chi_squared)
    )
