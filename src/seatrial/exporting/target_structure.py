"""What another simulator computes for a hull: the terms that it has, and the rigid body that they act on."""

from dataclasses import dataclass

from seatrial.data.folder.model_file import ModelFile

HULL = ("X_H", "Y_H", "N_H")
ADDED: tuple[str, ...] = ("xDotU", "yDotV", "nDotR")
"""Tags of added mass in surge, sway and yaw."""
OFF_COURSE = 0.2
"""v over u, and L r over u, at which quadratic terms are read off a model; chosen."""


@dataclass(frozen=True)
class RigidBody:
    """Mass [kg], yaw inertia about the centre of gravity [kg m^2], and how far forward of the origin that is [m]."""

    mass: float
    inertia: float
    x_G: float

    @property
    def inertia_at_origin(self) -> float:
        """Yaw inertia about the origin [kg m^2]."""
        return self.inertia + self.mass * self.x_G**2


@dataclass(frozen=True)
class ForceTerm:
    """A term of the target: `tag` times `first` times `second` (of u, v, r; ``|u|`` for a magnitude; empty: 1)."""

    tag: str
    force: str
    first: str
    second: str = ""
    sign: float = 1.0


@dataclass(frozen=True)
class TargetStructure:
    """What a simulator computes for one link.

    Attributes:
        terms: of damping.
        added_mass_sign: of xDotU, yDotV, nDotR for an added mass that is positive.
        is_inertial: whether added mass acts on the acceleration in space (u' - v r), else on the rate (u') alone.
    """

    terms: tuple[ForceTerm, ...]
    added_mass_sign: float
    is_inertial: bool


def unsuitable_hull(file: ModelFile) -> str:
    """Return why a model cannot be projected; empty where it can."""
    model = file.model
    absent = [s for s in ("u", "v", "r", "psi") if s not in model.states]
    if absent:
        return f"it has no state '{absent[0]}', and the target is a craft in surge, sway and yaw"
    names = {b.name for b in model.bindings}
    absent = [b for b in (*HULL, "X_sum", "Y_sum", "N_sum") if b not in names]
    if absent:
        return f"it has no binding '{absent[0]}', so that forces of hull and actuators cannot be separated"
    rigid = rigid_body(file)
    if rigid is None:
        return "neither the model nor its ship states the mass m and the inertia I_z that the link needs"
    if "M_u" in model.parameters and model.parameters["M_u"].value < rigid.mass:
        return (
            f"its M_u of {model.parameters['M_u'].value:.4g} kg is less than the mass m of {rigid.mass:.4g} kg, so "
            "that its forces are not in newtons; identify it with the bollard thrust of a thruster"
        )
    return ""


def rigid_body(file: ModelFile) -> RigidBody | None:
    """Return mass and inertia of the model or its ship; None where neither states both."""
    ship = {} if file.ship is None else file.ship.particulars
    values = {**ship, **{p.name: p.value for p in file.model.parameters}}
    if not {"m", "I_z"} <= set(values):
        return None
    return RigidBody(float(values["m"]), float(values["I_z"]), float(values.get("x_G", 0.0)))
