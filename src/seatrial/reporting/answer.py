"""The answer in words: what was asked, what was fitted, how well held-out runs are predicted, what to mind."""

from seatrial.core.results import Coefficient, Fit, Prediction, Symmetry
from seatrial.core.text.numbers import duration, estimate, exact, fixed, significant
from seatrial.core.text.words import (
    counted,
    decimals,
    extrapolated,
    interval,
    is_inside,
    listed,
    measure,
    reach,
    sentence,
)
from seatrial.core.values import Severity
from seatrial.estimation.estimate.settings import WHITE_INFLATION
from seatrial.reporting.telling import determined

DISAGREES = 3.0
LONGEST = 200
_ANGLES = (("theta", "pitch"), ("phi", "roll"))


def facts(fit: Fit) -> list[tuple[str, str]]:
    """Ship, model and records as pairs of name and text."""
    ship, trained, held = fit.ship, _with_role(fit, "training"), fit.validation()
    ratio = f"1:{exact(ship.scale)}"
    scale = f", model scale {ratio}" if ship.scale != 1.0 and ratio not in ship.name else ""
    length = f", L = {exact(ship.length)} m" if "L" in ship.particulars else ""
    free = sum(not c.fixed for c in fit.coefficients)
    seconds = sum(p.measured.duration for p in trained)
    return [
        ("Ship", f"{ship.name}{length}{scale}"),
        ("Model", f"{fit.model.name}, {counted(free, 'free coefficient')} of {len(fit.coefficients)}"),
        ("Fitted to", f"{counted(len(trained), 'run')}, {duration(seconds)} of records"),
        ("Held out", listed([p.record for p in held]) if held else "no run"),
        ("Method", fit.method.criterion),
    ]


def sentences(fit: Fit) -> list[str]:
    """The answer, most important first."""
    told = [
        *_held_out(fit),
        _covered(fit),
        *_extrapolated(fit),
        _rolling(fit),
        _not_told(fit),
        _coefficients(fit),
        _truth(fit),
        _priors(fit),
        _criterion(fit),
        _residuals(fit),
        _convergence(fit),
        _warnings(fit),
    ]
    return [sentence for sentence in told if sentence]


def _with_role(fit: Fit, role: str) -> list[Prediction]:
    return [p for p in fit.predictions if p.role == role]


def _held_out(fit: Fit) -> list[str]:
    held = fit.validation()
    if not held:
        return ["No run was held out: what follows shows how the model fits, not how it predicts."]
    return [_predicted(p, fit) for p in held[:4]] + (
        [f"{counted(len(held) - 4, 'further held-out run')} in the table."] if len(held) > 4 else []
    )


def _predicted(p: Prediction, fit: Fit) -> str:
    parts = []
    if "psi_deg" in p.rms:
        parts.append(f"{significant(p.rms['psi_deg'], 2)}° in heading")
    if "position_m" in p.rms:
        length = fit.ship.particulars.get("L", 0.0)
        share = f" ({significant(p.rms['position_m'] / length, 2)} L)" if length > 0 else ""
        parts.append(f"{significant(p.rms['position_m'], 2)} m in position{share}")
    if "z" in p.rms:
        parts.append(f"{significant(p.rms['z'], 2)} m in heave")
    parts += [f"{significant(p.rms[f'{name}_deg'], 2)}° in {said}" for name, said in _ANGLES if f"{name}_deg" in p.rms]
    if not parts and "r" in p.rms:
        parts.append(f"{significant(p.rms['r'] * 57.29578, 2)} deg/s in yaw rate")
    said = f"{p.record}, not fitted, is predicted open loop over {duration(p.measured.duration)}"
    errors = f" with errors of {listed(parts)} (rms)" if parts else ""
    return f"{said}{errors}{_floor(p) if parts else ''}.{_first_measures(p)}"


def _floor(p: Prediction) -> str:
    known = {"psi_deg": "°", "position_m": " m"}
    told = [f"{significant(p.floor[name], 2)}{unit}" for name, unit in known.items() if name in p.floor]
    return f"; process noise alone would leave {listed(told)}" if told else ""


def _first_measures(p: Prediction) -> str:
    known = {"overshoot_1_deg": ("first overshoot", "°"), "advance_L": ("advance", " L"),
             "tactical_diameter_L": ("tactical diameter", " L")}  # fmt: skip
    told = []
    for name, (label, unit) in known.items():
        m = p.measures.get(name)
        if m is not None and m.measured is not None and m.simulated is not None:
            digits = decimals(measure(name)[1], m)
            bounds = interval(m.lower, m.upper, digits)
            simulated = f"{fixed(m.simulated, digits)}{unit}{' ' + bounds if bounds else ''}"
            told.append(f"{label} {simulated}, measured {fixed(m.measured, digits)}{unit}")
    return f" Simulated {'; '.join(told)}." if told else ""


def _covered(fit: Fit) -> str:
    """How many measured values lie inside their predicted intervals; those without a width are no prediction."""
    judged = [is_inside(m) for p in fit.validation() for m in p.measures.values() if m.lower != m.upper]
    known = [inside for inside in judged if inside is not None]
    if not known:
        return ""
    return f"{sum(known)} of {len(known)} measured manoeuvring values lie inside their predicted 95 % intervals."


def _extrapolated(fit: Fit) -> list[str]:
    """One sentence for each held-out run that goes well beyond the training runs, the first four."""
    far = [p for p in fit.validation() if p.extrapolation and reach(p.extrapolation.index) == "beyond"]
    return [f"{p.record} is extrapolation, index {extrapolated(p.extrapolation)}" for p in far[:4] if p.extrapolation]


def _not_told(fit: Fit) -> str:
    """How much the records determine and what no such record can tell."""
    known = fit.identifiability
    if known is None:
        return ""
    said = [determined(fit)]
    if known.structural:
        more = len(known.structural) - 1
        further = f" ({counted(more, 'further change')} of this kind in the next section)" if more else ""
        said.append(f"Whatever the manoeuvre, {_hidden(known.structural[0])}{further}.")
    return " ".join(s for s in said if s)


def _rolling(fit: Fit) -> str:
    """Period, damping and metacentric height."""
    known = fit.rolling
    if known is None:
        return ""
    period, ratio = (estimate(e.value, 0.5 * (e.upper - e.lower), e.lower, e.upper)
                     for e in (known.natural_period, known.damping_ratio.times(100.0)))  # fmt: skip
    said = (
        f"The natural period at small angles is {period.value} s ({period.lower} to {period.upper} s), the linear "
        f"damping {ratio.value} % of critical ({ratio.lower} to {ratio.upper} %)"
    )
    height = known.metacentric_height
    if height is None:
        return f"{said}."
    gm = estimate(height.value, 0.5 * (height.upper - height.lower), height.lower, height.upper)
    return f"{said}; GM would be {gm.value} m ({gm.lower} to {gm.upper} m) with {known.assumed.partition(',')[0]}."


def _hidden(s: Symmetry) -> str:
    """A change no record shows: its text, or where that is long what it is about."""
    if len(s.text) <= LONGEST:
        return s.text.rstrip(".")
    return f"{listed(s.parameters)} can change together without showing in any such record"


def _criterion(fit: Fit) -> str:
    known = fit.disturbance
    if known is None:
        return ""
    active = [state for state, q in known.process.items() if q > 0]
    noise = f"process noise in {listed(active)}" if active else "no process noise"
    text = f" {sentence(known.text, [c.name for c in fit.coefficients])}" if known.text else ""
    return f"The criterion is {known.method}, with {noise}.{text}"


def _free(fit: Fit) -> list[Coefficient]:
    return [c for c in fit.coefficients if not c.fixed]


def _coefficients(fit: Fit) -> str:
    free = _free(fit)
    vague = [c.name for c in free if c.lower is not None and c.upper is not None and c.lower < 0 < c.upper]
    if not vague:
        return f"All {len(free)} free coefficients differ from zero at the 95 % level."
    return (
        f"{len(vague)} of {len(free)} free coefficients cannot be told from zero at the 95 % level ({listed(vague)})."
    )


def _truth(fit: Fit) -> str:
    known = [c for c in _free(fit) if c.truth is not None and c.lower is not None and c.upper is not None]
    if not known:
        return ""
    inside = [c for c in known if c.lower <= c.truth <= c.upper]  # type: ignore[operator]
    return f"{len(inside)} of {len(known)} 95 % intervals contain the known value of the coefficient."


def _priors(fit: Fit) -> str:
    off = [
        c.name
        for c in _free(fit)
        if c.prior_mean is not None
        and c.prior_standard_deviation
        and abs(c.estimate - c.prior_mean) > DISAGREES * c.prior_standard_deviation
    ]
    if not off:
        return ""
    return (
        f"{counted(len(off), 'coefficient').capitalize()} ended more than {DISAGREES:g} prior standard deviations from "
        f"the prior ({listed(off)}): records and prior disagree there."
    )


def _residuals(fit: Fit) -> str:
    if not fit.noise:
        return ""
    coloured = [
        n.channel
        for n, r in zip(fit.noise, fit.residuals, strict=True)
        if 1.0 + 2.0 * n.correlation_time * r.rate > WHITE_INFLATION
    ]
    if not coloured:
        return "The residuals are white in all channels: the model leaves nothing but noise."
    return (
        f"The residuals are coloured in {len(coloured)} of {len(fit.noise)} channels ({listed(coloured)}): model error "
        "or disturbances remain. The intervals allow for their correlation."
    )


def _convergence(fit: Fit) -> str:
    return "" if fit.solution.status.is_success else f"The search did not converge: {fit.solution.status.value}."


def _warnings(fit: Fit) -> str:
    codes = list(dict.fromkeys(f.code for f in fit.findings if f.severity is not Severity.INFO))
    return f"The checks warn of: {listed(codes)} (see Findings)." if codes else "The checks found nothing to warn of."
