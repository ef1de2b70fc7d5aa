"""What to warn of in a fit: records, bands, priors and optima that its numbers do not show."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results import Prediction
from seatrial.core.results.coefficients import REFERENCE_LEVEL, FeedbackEvidence
from seatrial.core.results.ship_motions import FrequencyResponse
from seatrial.core.text.numbers import p_value, percent, significant
from seatrial.core.text.words import counted, enumeration
from seatrial.core.values import NOTATION, Array, Finding, InputError, Record, Severity
from seatrial.data.trial import EstimateMethod
from seatrial.estimation.estimate.fit import Estimation, estimate_model
from seatrial.estimation.estimate.point_estimate import split_segments
from seatrial.estimation.estimate.process_noise import has_noise
from seatrial.estimation.identify.identification import Identification
from seatrial.estimation.identify.terms import COMPARED_ERRORS, judged_runs
from seatrial.estimation.predict.open_loop import rms_errors, simulate_open_loop
from seatrial.estimation.predict.session_offsets import new_session_offsets
from seatrial.physics.models.candidate_structures import POLES, SECOND_ORDER_TERMS, ZERO, with_second_order
from seatrial.physics.models.thruster_layout import Thruster, layout_of

# What to warn of where a controller was on while the training runs were recorded.

LEAST_AGREEMENT = 0.5
"""Correlation of a declared controller's orders with the input below which they contradict each other; chosen."""


def closed_loop_findings(estimation: Estimation) -> list[Finding]:
    """Return warnings of a closed loop that is fitted by output error, and of declarations that do not agree."""
    loop = estimation.noise_model.closed_loop
    if loop is None:
        return []
    findings = list(_contradictions(loop))
    if not estimation.has_process_noise and has_noise(estimation.estimate):
        was_compared = bool(estimation.noise_model.candidates)
        advice = (
            "runs left out decided for it; use the coefficients for predictions under the same controller"
            if was_compared
            else 'write method = "auto" under [estimate], without robust and segment_s, so that prediction error is '
            "compared with it"
        )
        findings.append(Finding(Severity.WARNING, "closed-loop", f"'{loop.input}' follows '{loop.output}', and the "
                                f"criterion is {estimation.criterion}: disturbances that are answered count as the "
                                "craft's own response", "", advice))  # fmt: skip
    return findings


def _contradictions(loop: FeedbackEvidence) -> Iterator[Finding]:
    if loop.reference_p is not None and loop.reference_p < REFERENCE_LEVEL:
        yield Finding(Severity.WARNING, "reference-residual", "the innovations follow earlier changes of the "
                      "reference, as those of a true model do not: model error, which the intervals do not cover",
                      p_value(loop.reference_p))  # fmt: skip
    agreement = loop.controller_correlation
    if agreement is not None and agreement < LEAST_AGREEMENT:
        yield Finding(Severity.WARNING, "controller-mismatch", f"'{loop.input}' is not what the declared controller "
                      "orders", f"correlation {significant(agreement, 2)}")  # fmt: skip


# A warning where the estimated disturbance moves a state by more than the state moves at all: no sea does that.

EXCEEDS_MOTION = "disturbance-exceeds-motion"
# of the disturbance, an open-loop error below which the model does not miss the state by anything like it; chosen
_LEAST_ERROR = 0.3


@dataclass(frozen=True)
class _Excess:
    """A state whose disturbance exceeds its motion: both, and the open-loop error (NaN: not measured), all SI."""

    state: str
    disturbed: float
    spread: float
    error: float

    @property
    def is_misfit(self) -> bool:
        """Whether the model misses the state by something like the disturbance."""
        return not self.error < _LEAST_ERROR * self.disturbed

    def text(self) -> str:
        unit = NOTATION[self.state].unit
        moved = f"{self.state}: {significant(self.disturbed, 2)} {unit} without steering"
        missed = f" and the model misses it by {significant(self.error, 2)} {unit}" if math.isfinite(self.error) else ""
        return f"{moved}, while the runs spread by {significant(self.spread, 2)} {unit}{missed}"


def misfit_disturbance(trained: Sequence[Prediction]) -> tuple[Finding, ...]:
    """Return a warning `disturbance-exceeds-motion` of the states whose noise exceeds their own spread.

    Where the model misses such a state by far less, open loop, it is no misfit: the intensity is not determined.

    trained: the training runs as the model has them, with what its process noise moves by itself.
    """
    found = list(_excesses(trained))
    undetermined = [one for one in found if not one.is_misfit]
    misfit = [one for one in found if one.is_misfit]
    findings = list[Finding]()
    if misfit:
        findings.append(Finding(
            Severity.WARNING, EXCEEDS_MOTION, "the estimated disturbance moves the craft by more than it moves in the "
            "runs: the model's misfit, not the sea, is likely", "; ".join(one.text() for one in misfit),
        ))  # fmt: skip
    if undetermined:
        names = enumeration([one.state for one in undetermined])
        findings.append(Finding(
            Severity.WARNING, EXCEEDS_MOTION, f"the estimated disturbance of {names} cannot be: the model without it "
            "misses far less, so that its size is not determined", "; ".join(one.text() for one in undetermined),
            f"state the sensors' noise of {names} under [noise], so that the filter does not choose it",
        ))  # fmt: skip
    return tuple(findings)


def _excesses(trained: Sequence[Prediction]) -> Iterator[_Excess]:
    for state in dict.fromkeys(name for p in trained for name in p.noise_floor if name in NOTATION):
        runs = [p for p in trained if state in p.simulated]
        samples = [p.simulated[state][np.isfinite(p.simulated[state])] for p in runs]
        spread = float(np.std(np.concatenate(samples))) if samples else math.nan
        error = max((p.rms[state] for p in runs if state in p.rms), default=math.nan)
        disturbed = max(p.noise_floor.get(state, 0.0) for p in trained)
        if disturbed > spread > 0.0:
            yield _Excess(state, disturbed, spread, error)


# Held-out runs that leave their 95 % bands far more often than chance would: intervals that promise too much.

LEAST_INSIDE = 0.7
"""Share of the samples of held-out runs inside a 95 % band below which the band is too narrow; chosen."""


def narrow_band_findings(predictions: Sequence[Prediction]) -> tuple[Finding, ...]:
    """Return a warning with the held-out runs and channels of which too little lies inside the band.

    Over the longest windows of each run, as on the first screen of the report.
    """
    outside = list[str]()
    for p in (one for one in predictions if one.role == "validation" and one.windows):
        longest = max(p.windows, key=lambda w: w.seconds)
        outside += [
            f"{100.0 * score.inside_band:.0f} % of {name} in {p.record}"
            for name, score in longest.scores.items()
            if score.inside_band is not None and score.inside_band < LEAST_INSIDE
        ]
    if not outside:
        return ()
    return (
        Finding(
            Severity.WARNING, "narrow-band",
            "held-out samples lie outside their 95 % band more often than chance explains",
            f"inside are {enumeration(outside)}",
        ),
    )  # fmt: skip


# What searches from several starting points say of the estimate: optima that are as good, and better ones.

_AS_GOOD = 2.0
"""Loss above the lowest (negative log-likelihood) up to which records hardly distinguish two optima; chosen: about the
95 % limit of one coefficient, half of 3.84."""
_APART = 3.0
"""Standard errors by which some coefficient differs at another optimum; chosen."""


def other_optima(estimation: Estimation) -> list[Finding]:
    """Return findings on ends of the search that explain the records as well with other coefficients.

    Ends are compared with the best one: where the criterion is another than that of the search, the estimate went on.
    Coefficients of instruments that the records showed later were not searched for.
    """
    problem, errors = estimation.estimate.problem, estimation.interval.standard_error
    findings = []
    for attempt in estimation.search_attempts[1:]:
        if attempt.loss > _AS_GOOD:
            continue
        best = estimation.search_attempts[0].values
        searched = [(name, e) for name, e in zip(problem.free, errors.tolist(), strict=False) if name in best]
        apart = {n: abs(attempt.values[n] - best[n]) / max(e, np.finfo(float).tiny) for n, e in searched}
        name = max(apart, key=lambda n: apart[n])
        if apart[name] > _APART:
            findings.append(Finding(
                Severity.WARNING, "equal-optimum", f"other coefficients explain the records as well: {name} = "
                f"{attempt.values[name]:.3g} instead of {best[name]:.3g}",
                f"search from {attempt.origin}: loss {attempt.loss:.2g} above the lowest",
            ))  # fmt: skip
    return findings


# Priors that the records contradict: the estimate lies many of their standard deviations away.

REFUTED = 3.0
"""Distance of an estimate from its prior's mean, in the prior's standard deviations, from which on records and prior
disagree: of a normal prior one in 370 lies so far out by chance; chosen."""
_MOST_NAMED = 6  # that a message holds, the farthest first; chosen


def refuted_prior_findings(estimation: Estimation) -> tuple[Finding, ...]:
    """Return a warning `prior-refuted` with the priors that the estimate left, and by how far; else nothing."""
    distances = {
        p.name: abs(p.value - p.prior.mean) / p.prior.standard_deviation
        for p in estimation.model.parameters.free
        if p.prior is not None and p.prior.standard_deviation > 0.0
    }
    off = sorted((n for n, d in distances.items() if d > REFUTED), key=lambda n: -distances[n])
    if not off:
        return ()
    sizes = [f"{name} by {significant(distances[name], 2)}" for name in off[:_MOST_NAMED]]
    more = f", and {len(off) - len(sizes)} more" if len(off) > len(sizes) else ""
    return (Finding(
        Severity.WARNING, "prior-refuted",
        f"the records contradict the priors of {counted(len(off), 'coefficient')}",
        f"prior standard deviations from their means: {', '.join(sizes)}{more}",
    ),)  # fmt: skip


# A warning where the model's frequency response leaves the region of the records' own.

# frequencies compared from which on a response is judged, and share of them inside the 95 % region below which it is
# named; chosen: chance leaves 95 % inside, and half outside are no longer a matter of estimators
_FEWEST_COMPARED, _LEAST_INSIDE = 5, 0.5


def response_findings(responses: Sequence[FrequencyResponse]) -> tuple[Finding, ...]:
    """Return a warning `frequency-response` with the responses of which the model misses more than half."""
    texts = list(_missed(responses))
    if not texts:
        return ()
    return (Finding(
        Severity.WARNING, "frequency-response", f"the model lies outside the 95 % region of the records in "
        f"{enumeration(texts, len(texts))} frequencies",
    ),)  # fmt: skip


def _missed(responses: Sequence[FrequencyResponse]) -> Iterator[str]:
    for r in responses:
        compared, inside = int(r.is_compared.sum()), int((r.is_inside & r.is_compared).sum())
        if compared >= _FEWEST_COMPARED and inside < _LEAST_INSIDE * compared:
            yield f"{r.output} over {r.input} at {compared - inside} of {compared}"


# Time constants that are estimated below the step of the records: what happens between two samples is not seen.

_SECONDS = "s"  # unit of time constants and delays


def short_time_constant_findings(estimation: Estimation) -> tuple[Finding, ...]:
    """Return a note `short-time-constant` on those free coefficients in s that are below the step; else nothing."""
    step, parameters = estimation.estimate.problem.data.dt, estimation.model.parameters
    short = [p for p in parameters.free if p.unit == _SECONDS and p.value < step]
    if not short:
        return ()
    names = " and ".join(p.name for p in short)
    sizes = ", ".join(f"{p.name} {significant(p.value, 2)} s" for p in short)
    verb = "is" if len(short) == 1 else "are"
    return (Finding(
        Severity.INFO, "short-time-constant", f"{names} {verb} below the step of the records",
        f"{sizes}; a sample every {significant(step, 2)} s",
    ),)  # fmt: skip


# Held-out runs of a kind of manoeuvre that no training run shows: predictions of them are extrapolations.

_MOST_RUNS = 3  # names that a message holds; chosen


def untrained_manoeuvre_findings(predictions: Sequence[Prediction]) -> tuple[Finding, ...]:
    """Return a warning `untrained-manoeuvre` for each kind that was held out and never fitted."""
    of_kind = dict[str, list[str]]()
    for p in predictions:
        if p.role == "validation" and p.extrapolation is not None and p.extrapolation.untrained_kind:
            of_kind.setdefault(p.extrapolation.untrained_kind, []).append(p.record)
    return tuple(
        Finding(
            Severity.WARNING, "untrained-manoeuvre", f"no training run is a {kind.replace('-', ' ')}",
            f"held out: {enumeration(names, _MOST_RUNS)}",
            "their bands are extrapolations, calibrated by other manoeuvres: read them as lower limits, or train a "
            f"{kind.replace('-', ' ')}",
        )
        for kind, names in of_kind.items()
    )  # fmt: skip


# Thrust that no training run shows: its coefficients are held, not sought; and thrust shown at one order alone.

_ASTERN = ("k_b", "p_b", "k_4")  # thrust at full command, exponent, loss with speed: docs/thrusters.md
_LEAST_ORDER = 0.02  # share of full command astern that drives a thruster, where it has no dead band; chosen
_ORDER_PERCENTILES = (10.0, 90.0)  # of the orders to one side: between them lie those that are held, not slews; chosen
_ONE_ORDER = 0.1  # share of full command between these percentiles up to which there was one order; chosen


@dataclass(frozen=True)
class _Side:
    """One direction of thrust: its name, the sign of its orders, and the two coefficients of its curve."""

    name: str
    sign: float
    symbols: tuple[str, str]


_SIDES = (_Side("ahead", 1.0, ("k_f", "p_f")), _Side("astern", -1.0, ("k_b", "p_b")))


def with_unexcited_thrust_held(model: Model, records: Sequence[Record]) -> tuple[Model, tuple[Finding, ...]]:
    """Return the model with the thrust astern of thrusters that no record drives astern held, and a finding of each.

    Without an order astern these coefficients change nothing, and a search carries them anywhere. A coefficient with a
    prior stays free. Models without thrusters are returned as they are.
    """
    if not model.has_thrusters:
        return model, ()
    layout, findings = layout_of(model), list[Finding]()
    for leader in layout.leaders:
        alike = [t for t in layout.thrusters if layout.leader(t) is leader]
        symbols = [symbol + layout.suffix(leader) for symbol in _ASTERN]
        held = [p.name for p in model.parameters.free if p.name in symbols and p.prior is None]
        if not held or any(_is_driven_astern(t, r) for t in alike for r in records):
            continue
        names = " or ".join(t.name for t in alike)
        model = model.with_parameters(model.parameters.fixed(*held))
        findings.append(
            Finding(
                Severity.WARNING, "no-thrust-astern", f"no training run has an order astern of {names}: "
                f"{enumeration(held)} are held where they start",
            )
        )  # fmt: skip
    return model, tuple(findings)


def single_order_findings(model: Model, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return a warning `single-order` for each curve of thrust whose both coefficients are free on one order alone.

    At one order any exponent fits with the thrust at full command that goes with it; elsewhere the curve is a guess.
    """
    if not model.has_thrusters:
        return ()
    layout, free = layout_of(model), {p.name for p in model.parameters.free}
    findings = list[Finding]()
    for leader in layout.leaders:
        alike = [t for t in layout.thrusters if layout.leader(t) is leader]
        for side in _SIDES:
            names = [symbol + layout.suffix(leader) for symbol in side.symbols]
            orders = np.concatenate([_orders(t, r, side.sign) for t in alike for r in records] or [np.zeros(0)])
            is_open = all(n in free and model.parameters[n].prior is None for n in names)
            if is_open and len(orders) and float(np.ptp(np.percentile(orders, _ORDER_PERCENTILES))) <= _ONE_ORDER:
                thrusters = " or ".join(t.name for t in alike)
                findings.append(_single_order(side, thrusters, names, float(np.median(orders))))
    return tuple(findings)


def _single_order(side: _Side, thrusters: str, names: Sequence[str], order: float) -> Finding:
    scale, exponent = names
    return Finding(
        Severity.WARNING, "single-order", f"the training runs hold orders {side.name} of {thrusters} only near "
        f"{percent(order)} % of full command: {scale} and {exponent} together give the thrust there, neither by itself",
        f"full command is {significant(1.0 / order, 2)} times that order",
        f"record a second order {side.name}, or fix {exponent} under [model.fixed]",
    )  # fmt: skip


def _is_driven_astern(thruster: Thruster, record: Record) -> bool:
    return bool(len(_orders(thruster, record, -1.0)))


def _orders(thruster: Thruster, record: Record, sign: float) -> Array:
    """The orders to one side that drive a thruster, as positive shares of full command."""
    command = thruster.command
    if command.channel not in record:
        return np.zeros(0)
    order = sign * (record[command.channel] - command.zero) / command.span
    return order[order > max(thruster.dead_band, _LEAST_ORDER)]


# A warning where a search from sample to sample led outside physics: which runs the model cannot have, and why.

LEAST_LOSS = 1.0 / 3.0
"""Share of its speed that a run loses, from which on a model without surge cannot have it; chosen."""
_WORST = 2.0  # times the median run's residuals from which on a run is named; chosen
_EDGE_SHARE = 0.1  # of a run, over which its speed is averaged at begin and end; chosen


def abandoned_criterion_finding(estimation: Estimation, records: Sequence[Record]) -> tuple[Finding, ...]:
    """Return a warning `search-abandoned` where whole runs took the place of another criterion; else nothing.

    records: the training runs, in their order.
    """
    if not estimation.abandoned:
        return ()
    losses = _speed_losses(estimation.model, records)
    worst = {} if losses else _worst_runs(estimation, records)
    named = [*losses, *worst]
    evidence = [f"{name} loses {100.0 * share:.0f} % of its speed, which the model does not have"
                for name, share in losses.items()]  # fmt: skip
    evidence += [f"{name} has {ratio:.1f} times the residuals of the median run" for name, ratio in worst.items()]
    listed = ", ".join(f'"{name}"' for name in named)
    ways = [f"leave them out, with leave_out = [{listed}] under [[records]]"] if 0 < len(named) < len(records) else []
    ways += ["take a model with surge (mmg, abkowitz)" if losses else "take a model with more terms"]
    return (Finding(
        Severity.WARNING, "search-abandoned",
        f"{estimation.abandoned}: these runs contradict the model from sample to sample, and the estimate is that of "
        "output error over whole runs", "; ".join(evidence), f"{', or '.join(ways)}",
    ),)  # fmt: skip


def _speed_losses(model: Model, records: Sequence[Record]) -> dict[str, float]:
    """Runs that lose much of their speed, of a model that has none, and the share that they lose."""
    if model.has_speed:
        return {}
    losses: dict[str, float] = {}
    for record in records:
        if "u" not in record:
            continue
        count = max(1, round(_EDGE_SHARE * len(record)))
        first, last = (float(np.nanmedian(record["u"][part])) for part in (slice(count), slice(-count, None)))
        if first > 0.0 and 1.0 - last / first > LEAST_LOSS:
            losses[record.name] = 1.0 - last / first
    return losses


def _worst_runs(estimation: Estimation, records: Sequence[Record]) -> dict[str, float]:
    """Runs whose residuals are much larger than those of the median run, and how many times."""
    problem, values = estimation.estimate.problem, estimation.residuals
    if len(problem.data.runs) != len(records) or len(records) < 2:
        return {}
    squares = np.zeros(len(records))
    for column, noise in zip(values.T, problem.noise, strict=True):
        pieces = split_segments(problem, column / noise)
        squares += [np.mean(np.square(np.concatenate([pieces[k] for k in problem.data.run_segments(r)])))
                    for r in range(len(records))]  # fmt: skip
    ratios = np.sqrt(squares / np.median(squares))
    return {record.name: float(ratio) for record, ratio in zip(records, ratios, strict=True) if ratio > _WORST}


# The order of a steering model: do the records show a second pole and a zero?

_POLES_APART = 3.0  # standard errors of what lies between zero and pole, from which on they are two; chosen
_MOST_LEFT = 0.95  # of the residuals' standard deviation that is left where no runs are held out; chosen


def second_order_finding(
    task: Identification, estimation: Estimation, predictions: Sequence[Prediction]
) -> tuple[Finding, ...]:
    """Return a warning `held-coupling` where the training runs show a second pole and a zero; else nothing.

    Both orders are fitted by output error over whole runs. The second is named where its zero lies at neither pole and
    held-out runs, simulated whole, are predicted better; where none are held out, it leaves clearly less of the others.
    """
    model = task.trial.model
    wide = with_second_order(model)
    if wide is model or (estimation.whiteness.is_white and not estimation.has_process_noise):
        return ()
    settings = replace(task.settings, method=EstimateMethod.OUTPUT_ERROR)
    try:
        first, second = (estimate_model(m, task.runs, settings, task.options) for m in (model, wide))
        held = _held_out_ratio(second, judged_runs(predictions))
    except InputError:
        return ()
    left = _rms_of_noise(second.residuals, first) / _rms_of_noise(first.residuals, first)
    if not _is_shown(second) or (left > _MOST_LEFT if np.isnan(held) else held >= 1.0):
        return ()
    free = second.estimate.problem.free
    values = [
        f"{n} {significant(v, 3)}" for n, v in zip(free, second.estimate.common_parameters.tolist(), strict=False)
    ]
    error = "" if np.isnan(held) else f" and {significant(held, 2)} of the held-out error"
    names = ", ".join(f'"{n}"' for n in free)
    return (Finding(
        Severity.WARNING, "held-coupling",
        f"{enumeration(SECOND_ORDER_TERMS)} are no terms of the model and the training runs speak against it",
        f"tried here: with them {significant(left, 2)} of the residuals{error} are left, with {enumeration(values)}",
        f'under [model] write name = "{wide.name}", free = [{names}]',
    ),)  # fmt: skip


def _is_shown(estimation: Estimation) -> bool:
    """Return whether the zero lies at neither pole: there it leaves a model of first order."""
    free, interval = estimation.estimate.problem.free, estimation.interval
    values = estimation.estimate.common_parameters
    zero, *poles = (free.index(n) for n in (ZERO, *POLES))
    sizes = [abs(values[zero] - values[pole]) for pole in poles]
    weights = [np.eye(1, len(interval.covariance), zero)[0] - np.eye(1, len(interval.covariance), p)[0] for p in poles]
    errors = [float(np.sqrt(w @ interval.covariance @ w)) for w in weights]
    return all(size > _POLES_APART * error for size, error in zip(sizes, errors, strict=True))


def _rms_of_noise(residuals: Array, weights: Estimation) -> float:
    """Return the rms over the noise of an estimate."""
    return float(np.sqrt(np.nanmean((residuals / weights.estimate.problem.noise) ** 2)))


def _held_out_ratio(estimation: Estimation, held: Sequence[Prediction]) -> float:
    """Return the geometric mean over runs, simulated whole, of the errors over those of the fit; NaN: none is held."""
    ratios = list[float]()
    for p in held:
        offsets = new_session_offsets(estimation.estimate, p.measured).expected
        run = simulate_open_loop(estimation.estimate.problem, estimation.model, p.measured, offsets, p.initial_seconds)
        errors = rms_errors(p.measured, run.record)
        ratios += [errors[key] / p.rms[key] for key in COMPARED_ERRORS if p.rms.get(key, 0.0) > 0.0]
    return float(np.exp(np.mean(np.log(ratios)))) if ratios else np.nan
