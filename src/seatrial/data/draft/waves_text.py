"""What a drafted trial needs of a craft in waves: its hull's stiffness, waves met, how elevation becomes force."""

from seatrial.data.draft.ship_estimates import EstimatedValue, StatedSize, main_dimensions, mass_properties
from seatrial.physics.hydro.dispersion import G

# Parsons 2003, Parametric design, in Lamb (ed.), Ship Design and Construction, vol. 1, SNAME, ch. 11
_SOURCE = "Parsons 2003"
ASSUMED = "ASSUMED"
"""Mark of a line of a draft that holds what is usual, not what a log shows."""


def ship_in_waves(size: StatedSize) -> tuple[EstimatedValue, ...]:
    """Return breadth, draught, mass, pitch inertia and stiffness [SI] of a ship of this size."""
    form, mass = size.form, {mass_property.key: mass_property for mass_property in mass_properties(size)}
    fullness = (
        1.0 + 2.0 * form.C_b
    ) / 3.0  # waterplane coefficient; Schneekluth & Bertram 1998, eq. (1.58), V sections
    pitch = 0.350 * fullness**2 - 0.405 * fullness + 0.146  # I_L / (B L^3); D'Arcangelo 1969, in Parsons 2003
    weight = size.density * G
    water = f"in water of {size.density:g} kg/m^3" if size.rho else "in sea water"
    text = f"{water}, of a waterplane with C_WP {fullness:.2f} ({_SOURCE})"
    return (
        *main_dimensions(size),
        mass["m"],
        EstimatedValue("I5", mass["I_z"].value, "kg m^2, in pitch, gyradius L/4"),
        EstimatedValue("c33", weight * fullness * form.L * form.B, f"N/m, heave by heave, {text}"),
        EstimatedValue("c35", 0.0, "N/rad, heave by pitch; 0 of a waterplane alike fore and aft"),
        EstimatedValue("c53", 0.0, "N m/m, pitch by heave; equal to c35"),
        EstimatedValue("c55", weight * pitch * form.B * form.L**3, f"N m/rad, pitch by pitch, {text}"),
    )


def wave_lines(speed: float | None) -> list[str]:
    """Return what the waves did to the runs, as it is in a towing tank; a ship's log states heading and speed.

    speed: m/s, as the headers of all runs state it; None: they do not.
    """
    known = f"speed = {speed:g}    # m/s, as the header says" if speed is not None else ""
    return [
        "",
        "[records.waves]",
        f'heading = {{ value = 180, unit = "deg" }}    # {ASSUMED}: head seas; 0 is following, 90 beam',
        known or f"speed = 0.0    # {ASSUMED}: m/s of the craft, or of the carriage that tows it",
    ]


def excitation_lines() -> list[str]:
    """Return how the elevation becomes a force."""
    return [
        "[excitation]",
        'source = "box"    # wave forces on a box of L, B and d; "table" or "capytaine": of the hull',
        "",
    ]
