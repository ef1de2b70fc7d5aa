"""How far a state and an input leave the range of the training runs, as an equation that the printers write.

The largest of the ratios that `estimation.information.extrapolation` takes of a whole run, here of one instant: yaw
rate, drift and rudder angle over the largest of the training runs, speed over their fastest, their slowest over speed,
and for commands of thrusters 1 and how far they exceed those of the training runs, as shares of full command.
Combinations of command and speed (quadrants) and sides of the rudder are left out.
"""

from typing import TYPE_CHECKING

from seatrial.core.equations import Binding
from seatrial.estimation.information.extrapolation import COMMAND, COMMAND_GAIN, NEGLIGIBLE, REST_SHARE
from seatrial.exporting.source import ExportSource, plain
from seatrial.physics.models.thruster_layout import Thruster, ThrusterLayout

if TYPE_CHECKING:
    import sympy as sp

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
    limits = {n: v for n, v in limits.items() if n != "slowest" or "fastest" in limits}
    if not {"slowest", "fastest"} <= set(limits):
        return limits
    kinds = [f"{COMMAND}{t.name} {side}" for t in _thrusters(source) for side in ("ahead", "astern")]
    return limits | {name: envelope[name] for name in kinds if name in envelope}


def _thrusters(source: ExportSource) -> tuple[Thruster, ...]:
    layout = source.model.equations.layout
    return ThrusterLayout.from_text(layout).thrusters if layout else ()


def range_text(source: ExportSource) -> str:
    """Return the range as a sentence."""
    limits = identified_range(source)
    if not limits:
        return "Identified range: the model file states none."
    parts = [f"{label} {sign} {limits[n]:.4g} {unit}" for n, (label, sign, unit) in _LABELS.items() if n in limits]
    parts += [f"{plain(n)} <= {100.0 * v:.3g} %" for n, v in limits.items() if n.startswith(COMMAND)]
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
    scaled = [ratios[n] / sp.Float(limits[n]) for n in limits if n in ratios]
    for thruster in _thrusters(source):
        share = _command_share(thruster)
        for side, sign in (("ahead", 1), ("astern", -1)):
            name = f"{COMMAND}{thruster.name} {side}"
            if name in limits:
                beyond: sp.Expr = sp.Max(sign * share - sp.Float(limits[name]), 0)
                scaled.append(sp.Add(1, sp.Float(COMMAND_GAIN) * beyond))
    if "slowest" in limits:
        scaled.append(sp.Float(max(limits["slowest"], rest)) / sp.Max(speed, sp.Float(rest)))
    return Binding.from_expression(RANGE_USE, sp.Max(*scaled), "training runs")


def _command_share(thruster: Thruster) -> "sp.Expr":
    """Return a thruster's share of full command; reading at rest and span are parameters of the model."""
    import sympy as sp

    zero, span = (sp.Symbol(f"{name}_{thruster.name}", real=True) for name in ("zero", "span"))
    return (sp.Symbol(thruster.command.channel, real=True) - zero) / span
