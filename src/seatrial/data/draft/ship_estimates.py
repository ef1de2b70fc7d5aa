"""What a ship's length alone says of its mass properties: values for a draft, to be replaced by better ones."""

from dataclasses import dataclass

from seatrial.data.trial.estimated_values import ESTIMATED
from seatrial.physics.hydro.empirical import ZHOU, HullForm, added_mass, displacement

# L/B, B/d and C_b of a ship of which only the length is stated; chosen: in the middle of the forms of Zhou's regression
_LENGTH_TO_BREADTH, _BREADTH_TO_DRAUGHT, _BLOCK = 6.0, 3.0, 0.65
_SEA_WATER = 1025.0  # kg/m^3 (ITTC 7.5-02-01-03, sea water at 15 degC: 1026)
_DIGITS = 4  # significant ones of an estimate; those of sea water


@dataclass(frozen=True)
class EstimatedValue:
    """One value of a draft: key, number, unit and meaning, and how it was estimated."""

    key: str
    value: float
    text: str

    @property
    def line(self) -> str:
        """The line of the trial file."""
        return f"{self.key} = {_rounded(self.value)}    # {ESTIMATED}: {self.text}"


def mass_properties(length: float) -> tuple[EstimatedValue, ...]:
    """Return mass, centre of gravity, inertia [SI] and water density of a ship of this length [m]."""
    values = displacement(hull_form(length), _SEA_WATER).values
    form = f"L/B {_LENGTH_TO_BREADTH:g}, B/d {_BREADTH_TO_DRAUGHT:g}, C_b {_BLOCK:g}"
    return (
        EstimatedValue("m", values["m"], f"kg, of a hull with {form}; write the displacement if you know it"),
        EstimatedValue("x_G", values["x_G"], "m forward of midship"),
        EstimatedValue("I_z", values["I_z"], "kg m^2, gyradius L/4 (Yasukawa & Yoshimura 2015)"),
        EstimatedValue("rho", values["rho"], "kg/m^3, sea water; fresh water has 1000"),
    )


def added_masses(length: float) -> tuple[EstimatedValue, ...]:
    """Return the acceleration derivatives over rho/2 L^3 and rho/2 L^5 of a ship of this length [m]."""
    form = hull_form(length)
    estimate = added_mass(form)
    names = {"X_udot": "m_x_prime", "Y_vdot": "m_y_prime", "N_rdot": "J_z_prime"}
    text = f"{ZHOU}, for {estimate.limits}; of other forms a guess"
    return tuple(EstimatedValue(key, -estimate.values[one] * form.d / form.L, text) for key, one in names.items())


def hull_form(length: float) -> HullForm:
    """Return a form of this length [m], of a ship of which nothing else is stated."""
    breadth = length / _LENGTH_TO_BREADTH
    return HullForm(length, breadth, breadth / _BREADTH_TO_DRAUGHT, _BLOCK)


def _rounded(value: float) -> str:
    """The number with four digits, as TOML writes a float."""
    number = f"{value:.{_DIGITS}g}"
    return number if "." in number or "e" in number else f"{number}.0"
