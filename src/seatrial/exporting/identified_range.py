"""How far a state and an input leave the range of the training runs, as an equation that the printers write.

The largest of the ratios that `estimation.information.extrapolation` takes of a whole run, here of one instant: yaw
rate, drift and rudder angle over the largest of the training runs, speed over their fastest, their slowest over speed.
Commands of thrusters are left out.
"""

from seatrial.core.equations import Binding
from seatrial.estimation.information.extrapolation import NEGLIGIBLE, REST_SHARE
from seatrial.exporting.source import ExportSource

RANGE_USE = "range_use"
"""Name of the output: at most 1 within the identified range."""
_LABELS = {
    "slowest": ("speed", ">=", "m/s"), "fastest": ("speed", "<=", "m/s"), "drift": ("|drift|", "<=", "rad"),
    "yaw_rate": ("|yaw rate|", "<=", "rad/s"), "rudder": ("|rudder|", "<=", "rad"),
}  # fmt: skip


def identified_range(source: ExportSource) -> dict[str, float]:
    """Return the limits that the model file states and the model can leave: as in `motion_envelope`, SI."""
    basis, model = source.file.interval_basis, source.model
    symbols = {*model.states, *model.input_names}
    needed = {"yaw_rate": {"r"}, "drift": {"u", "v"}, "rudder": {"delta"}, "fastest": {"u"}, "slowest": {"u"}}
    envelope = {} if basis is None else basis.training_envelope
    limits = {n: envelope[n] for n in needed if n in envelope and envelope[n] > NEGLIGIBLE[n] and needed[n] <= symbols}
    return {n: v for n, v in limits.items() if n != "slowest" or "fastest" in limits}


def range_text(source: ExportSource) -> str:
    """Return the range as a sentence."""
    limits = identified_range(source)
    if not limits:
        return "Identified range: the model file states none."
    parts = [f"{label} {sign} {limits[n]:.4g} {unit}" for n, (label, sign, unit) in _LABELS.items() if n in limits]
    return f"Identified range: {', '.join(parts)}."


def range_use(source: ExportSource) -> Binding | None:
    """Return the equation of `range_use`; None where the model file states no range."""
    import sympy as sp

    limits = identified_range(source)
    if not limits:
        return None
    u, v, r, delta = (sp.Symbol(name, real=True) for name in ("u", "v", "r", "delta"))
    speed = sp.sqrt(u**2 + v**2) if "v" in source.model.states else sp.Abs(u)
    rest = max(REST_SHARE * limits.get("fastest", 0.0), NEGLIGIBLE["slowest"])
    ratios: dict[str, sp.Expr] = {
        "yaw_rate": sp.Abs(r), "drift": sp.Abs(sp.atan2(-v, u)), "rudder": sp.Abs(delta), "fastest": speed,
    }  # fmt: skip
    scaled = [ratios[n] / sp.Float(limits[n]) for n in limits if n != "slowest"]
    if "slowest" in limits:
        scaled.append(sp.Float(max(limits["slowest"], rest)) / sp.Max(speed, sp.Float(rest)))
    return Binding.from_expression(RANGE_USE, sp.Max(*scaled), "training runs")
