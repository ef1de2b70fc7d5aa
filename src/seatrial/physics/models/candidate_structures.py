"""Models worth comparing on the same records: families, terms beyond a model's own, an unstable twin."""

from collections.abc import Iterable, Mapping
from dataclasses import replace
from types import MappingProxyType

from seatrial.core.equations import Model
from seatrial.core.values import Parameters
from seatrial.physics.models.registry import family_of, model_named

# Families of models worth comparing on the same records: which parameters a structure frees beyond the trial's own.

SURGE_TERMS = ("X_u", "X_uu", "X_vv", "X_rr", "X_dd", "X_vr")
"""What surge of an expansion may need: resistance, and the speed that drift, turning and rudder cost."""

FREED_PARAMETERS: Mapping[str, Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "nomoto": {"gain that falls with the yaw rate": ("alpha",)},
        "nomoto2": {"gain that falls with the yaw rate": ("alpha",)},
        "mmg": {
            "side forces of the screw": ("Y_T", "N_T"),
            "asymmetric hull": ("Y_0", "N_0"),
            "rudder and its inflow": ("a_H", "gamma_R_plus", "gamma_R_minus", "l_R_prime"),
            "added masses": ("m_x_prime", "m_y_prime", "J_z_prime"),
            "even terms": ("Y_dd", "N_dd"),
        },
        "son_nomoto": {
            "heel in sway and yaw": ("Y_phi", "N_phi"),
            "roll rate in sway and yaw": ("Y_p", "N_p"),
            "cubic roll moment": ("K_vvv", "K_rrr", "K_vvr", "K_vrr"),
            "drift and heel": ("Y_vvphi", "Y_vphiphi", "N_vvphi", "N_vphiphi"),
            "damping at rest": ("b_1", "b_2"),
        },
        "abkowitz": {
            "cubic rudder": ("Y_ddd", "N_ddd"),
            "rudder and drift": ("Y_vvd", "Y_vdd", "N_vvd", "N_vdd"),
            "speed lost by drift and rudder": ("X_vr", "X_dd"),
            "change with speed": ("Y_vu", "Y_ru", "N_vu", "N_ru"),
        },
        "waterjet": {"inertia": ("m_x", "m_y", "J_z"), "yaw moments of drift and turn": ("N_vrr", "N_vvr")},
        "waterjet_candidates": {"inertia": ("m_x", "m_y", "J_z")},
        "thrusters": {
            "side force of thrust": ("Y_T",),
            "moment of speed": ("N_u", "N_uu"),
            "sway and yaw coupled": ("N_v", "Y_r", "N_uv", "Y_ur"),
        },
    }
)
OMITTED_PARAMETERS: Mapping[str, Mapping[str, tuple[str, ...]]] = MappingProxyType(
    {
        "roll": {
            f"{damping} damping, {restoring} restoring": (*without, *neither)
            for damping, without in (("linear", ("b_2", "b_3")), ("quadratic", ("b_3",)), ("cubic", ()))
            for restoring, neither in (("linear", ("c_3", "c_5")), ("cubic", ("c_5",)), ("fifth-order", ()))
        }
    }
)
"""Families that count the other way: which parameters a structure leaves out, at zero."""


def structural_terms(model_name: str) -> frozenset[str]:
    """Return the parameters that a structure of this model's family may have or lack, and what surge may need."""
    family = family_of(model_name)
    families = (FREED_PARAMETERS.get(family, {}), OMITTED_PARAMETERS.get(family, {}))
    return frozenset(SURGE_TERMS).union(*(names for family in families for names in family.values()))


def candidate_terms(model: Model) -> tuple[str, ...]:
    """Return the terms that a choice of terms may keep or drop: free ones, and those of its family that are held at 0.

    Of a model without a family these are all parameters that it holds at 0: each model declares its candidates so.
    """
    has_family = family_of(model.name) in {*FREED_PARAMETERS, *OMITTED_PARAMETERS}
    declared = structural_terms(model.name) if has_family else frozenset(model.parameters.names)
    return tuple(p.name for p in model.parameters if p.free or (p.name in declared and p.value == 0.0))


PHYSICAL_SIGNS: Mapping[str, Mapping[str, int]] = MappingProxyType(
    {
        "mmg": {"m_x_prime": 1, "m_y_prime": 1, "J_z_prime": 1, "R_0": 1, "Y_v": -1, "N_r": -1},
        "mmg_roll": {"m_x_prime": 1, "m_y_prime": 1, "J_z_prime": 1, "R_0": 1, "Y_v": -1, "N_r": -1, "GM": 1, "b_1": 1},
        "abkowitz": {"X_udot": -1, "Y_vdot": -1, "N_rdot": -1, "Y_v": -1, "N_r": -1},
        "abkowitz_roll": {
            "X_udot": -1,
            "Y_vdot": -1,
            "N_rdot": -1,
            "K_pdot": -1,
            "Y_v": -1,
            "N_r": -1,
            "K_p": -1,
            "GM": 1,
        },
        "son_nomoto": {
            "m_x_prime": 1,
            "m_y_prime": 1,
            "J_z_prime": 1,
            "J_x_prime": 1,
            "GM": 1,
            "X_uu": -1,
            "Y_v": -1,
            "N_r": -1,
            "K_p": -1,
        },
        "waterjet": {"m_x": 1, "m_y": 1, "J_z": 1},
        "waterjet_candidates": {"m_x": 1, "m_y": 1, "J_z": 1},
    }
)
"""Sign of masses and of damping at small motions, which no choice of a model may turn: drift and yaw rate are opposed
by the forces that they cause (Newman 1977, Marine Hydrodynamics, section 6)."""

PRIOR_FACTORS = (0.5, 3.0)
SEGMENT_FACTORS = (0.7, 1.5)  # of the segments' length, by which a choice of structure is repeated; chosen


# Models with all terms that a choice of structure may take, beyond those that a model has.

_WIDER: Mapping[str, str] = MappingProxyType({"waterjet": "waterjet_candidates"})


def with_candidate_terms(model: Model) -> Model:
    """Return the model with every candidate term known for it, free and zero; the model itself where none is."""
    if model.name not in _WIDER:
        return model
    wide = model_named(_WIDER[model.name]).with_held(model.held)
    given = {p.name: p for p in model.parameters.items}
    return replace(wide, parameters=Parameters(tuple(given.get(p.name, p) for p in wide.parameters.items)))


def with_terms(model: Model, names: Iterable[str]) -> Model:
    """Return the model if it has all parameters of these names, else with its candidate terms, held where they are."""
    if set(names) <= set(model.parameters.names):
        return model
    wide = with_candidate_terms(model)
    return wide.with_parameters(wide.parameters.fixed(*(n for n in wide.parameters.names if n not in model.parameters)))


# The steering model of the next order: a second pole and a zero of the rudder's transfer function.

POLES, ZERO = ("T_1", "T_2"), "T_3"
SECOND_ORDER_TERMS = ("T_2", ZERO)


def with_second_order(model: Model) -> Model:
    """Return a model of first order with a second pole and a zero, free.

    Another model is returned itself, and one whose time constant is fixed or has a prior: it is that of no pole.
    """
    if model.name != "nomoto" or not model.parameters["T"].free or model.parameters["T"].prior is not None:
        return model
    wide, given = model_named("nomoto2").with_held(model.held), {p.name: p for p in model.parameters.items}
    slow = replace(given.pop("T"), name="T_1", meaning=wide.parameters["T_1"].meaning)
    items = (slow if p.name == slow.name else given.get(p.name, p) for p in wide.parameters.items)
    return replace(wide, parameters=Parameters(tuple(items)))


# The twin of a steering model that does not hold its course: where a search for such a ship begins.

_SLOW_TIME_CONSTANTS = ("T", "T_1")


def course_unstable(model: Model) -> Model:
    """Return a steering model with the gain and the slow time constant of the other sign, which turns by itself.

    K delta / T, by which the rudder acts, stays as it is. Another model, or one whose signs are bounded or fixed, is
    returned itself.
    """
    parameters = model.parameters
    names = [name for name in ("K", *_SLOW_TIME_CONSTANTS) if name in parameters.free_names]
    is_bounded = any(not parameters[name].lower <= -parameters[name].value <= parameters[name].upper for name in names)
    if len(names) != 2 or is_bounded:  # the gain and one time constant
        return model
    return model.with_values({name: -parameters[name].value for name in names})
