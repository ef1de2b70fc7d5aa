"""What is stated of a ship and what follows from it: mass, rudder, propeller, whether it runs in a basin."""

import math
import re
from collections.abc import Iterable
from dataclasses import dataclass, fields

import numpy as np

from seatrial.core.text.numbers import percent
from seatrial.core.values import InputError, si_unit
from seatrial.core.values.notation import UNIT_WORDS
from seatrial.data.draft.column_guess import ColumnGuess
from seatrial.data.draft.naming import guess_by_name
from seatrial.data.draft.survey import LogSurvey
from seatrial.data.read.formats.text import decoded_text
from seatrial.data.trial.plausibility import ESTIMATED
from seatrial.data.trial.priors import USUAL_PROPELLER
from seatrial.physics.hydro.empirical import (
    RESISTANCE,
    ZHOU,
    HullForm,
    added_mass,
    displacement,
    interaction_wake,
    propulsion,
    thrust_coefficient,
)
from seatrial.physics.hydro.excitation import SEA_WATER, G
from seatrial.physics.models.published import twin_screw_formulas

# What a ship's stated size says of its mass, rudder and propeller: values for a draft, until better ones are known.

# L/B, B/d and C_b of a ship of which only the length is stated; chosen: in the middle of the forms of Zhou's regression
_LENGTH_TO_BREADTH, _BREADTH_TO_DRAUGHT, _BLOCK = 6.0, 3.0, 0.65
_BLOCKS = (0.2, 1.0)  # of anything that floats: a slender catamaran's hulls within L, B and d, a box
_SPAN = 0.75  # height of a rudder over the draught; chosen: between full ships' 0.7 and fine ships' 0.8
_DIAMETERS = (0.35, 0.75)  # range of a propeller's diameter over the draught; chosen: small models, ferries
_OFF_CENTRE = 0.22  # place of two screws off the centre line over the breadth; chosen: ferries
_THRUST = 0.18  # thrust coefficient of a ship's propeller under way; chosen: KVLCC2's is 0.20, of faster ships less
_PITCH_RATIOS = np.linspace(0.5, 1.4, 91)  # P/D of the B series (Oosterveld & van Oossanen 1975)
_ADVANCES = (0.25, 1.2)  # range of advance ratios beyond which nothing drives a ship; chosen
_FASTEST = 0.4  # Froude number beyond which a hull no longer displaces its way as those of the regressions; chosen
# areas above water over B^2 and L^2; chosen: laden tankers have 0.6 and 0.06, ferries 1 and 0.14
_FRONTAL, _LATERAL = 0.8, 0.1
_DIGITS = 4  # significant ones of an estimate; those of sea water
# Standard deviations over the value, of what is estimated; chosen, but for those with a source.
_USUAL_ERROR = 0.1
# of a mass by what is stated: length; length and breadth; length, breadth and draught. L/B is within a sixth, B/d
# within a fifth, C_b within 0.08
_MASS_ERRORS = (0.35, 0.25, 0.12)
_INERTIA_ERROR = 0.16  # gyradii of ships are 0.25 L within 0.02 L (ITTC 7.5-02-07-02.1 takes 0.25 L)
_ADDED_MASS_ERRORS = (0.3, 0.15)  # of a form by rules; of one that is stated, as Zhou's regression scatters
BREADTH_ERROR, _DRAUGHT_ERROR = 0.17, 0.25
"""Of dimensions by the length."""
_WATER_ERROR = 0.025  # between fresh and salt
_STATED_UNITS = {
    "length": "m", "beam": "m", "draught": "m", "mass": "kg", "gear": "turns", "rho": "kg/m^3",
    "scale": "model lengths", "propeller": "m", "rudder": "m^2",
    "gm": "m",
}  # fmt: skip


@dataclass(frozen=True)
class StatedSize:
    """What is stated of a craft; 0: not stated.

    Attributes:
        length: between perpendiculars [m].
        beam: breadth at the waterline [m].
        draught: m.
        mass: kg.
        gear: turns of the engine over those of the propeller.
        rho: density of the water [kg/m^3].
        scale: ship length over that of a model, 40 for a model 1:40.
        propeller: diameter [m].
        rudder: area [m^2].
        gm: metacentric height [m].
        antenna: of the GNSS receiver, m forward of midship, negative abaft; None: not stated.
        name: of the craft, as it stands in the report; empty: not stated.
    """

    length: float = 0.0
    beam: float = 0.0
    draught: float = 0.0
    mass: float = 0.0
    gear: float = 0.0
    rho: float = 0.0
    scale: float = 0.0
    propeller: float = 0.0
    rudder: float = 0.0
    gm: float = 0.0
    antenna: float | None = None
    name: str = ""

    def __post_init__(self) -> None:
        for name, unit in _STATED_UNITS.items():
            if not 0.0 <= getattr(self, name) < math.inf:
                raise InputError(f"{name} = {getattr(self, name):g}: a {name} in {unit} is positive; correct it")
        if self.antenna is not None and not math.isfinite(self.antenna):
            raise InputError(f"antenna = {self.antenna:g}: its place in m forward of midship is finite; correct it")
        if not self.length and (self.beam or self.draught or self.mass):
            raise InputError("beam, draught and mass say nothing without the length; state it as well (init --length)")

    @property
    def density(self) -> float:
        """Of the water [kg/m^3]; of sea water where it is not stated."""
        return self.rho or SEA_WATER

    @property
    def form(self) -> HullForm:
        """The hull, with rules for what is not stated; the displacement is kept where it is stated.

        Raises:
            InputError: no hull has so little or so much volume within these dimensions.
        """
        volume = self.mass / self.density
        beam, draught = self.beam, self.draught
        if not beam and draught and volume:
            beam = volume / (self.length * draught * _BLOCK)
        elif not beam and volume:
            beam = math.sqrt(volume * _BREADTH_TO_DRAUGHT / (self.length * _BLOCK))
        beam = beam or self.length / _LENGTH_TO_BREADTH
        if not draught:
            draught = volume / (self.length * beam * _BLOCK) if volume else beam / _BREADTH_TO_DRAUGHT
        block = volume / (self.length * beam * draught) if volume else _BLOCK
        if not _BLOCKS[0] <= block <= _BLOCKS[1]:
            raise InputError(
                f"a mass of {self.mass:g} kg in L {self.length:g} m, B {beam:.3g} m, d {draught:.3g} m is a block "
                f"coefficient of {block:.2g}, which no hull has; correct mass, length, beam or draught"
            )
        return HullForm(self.length, beam, draught, block)

    @property
    def rules(self) -> str:
        """What is assumed of the hull, for people."""
        ratios = (
            ("" if self.beam else f"L/B {self.form.L / self.form.B:.3g}"),
            ("" if self.draught else f"B/d {self.form.B / self.form.d:.3g}"),
            f"C_b {self.form.C_b:.2g}",
        )
        return ", ".join(ratio for ratio in ratios if ratio)


UNSTATED = StatedSize()
"""Nothing is stated of the craft."""


@dataclass(frozen=True)
class EstimatedValue:
    """One value of a draft: key, number, unit and meaning, and how it was estimated, unless it was stated.

    error: standard deviation of an estimate over the value.
    """

    key: str
    value: float
    text: str
    is_stated: bool = False
    error: float = _USUAL_ERROR

    @property
    def line(self) -> str:
        """The line of the trial file."""
        number = _as_float(f"{self.value:.12g}" if self.is_stated else f"{self.value:.{_DIGITS}g}")
        within = f"within {percent(self.error)} %, " if self.value else ""
        return f"{self.key} = {number}    # {'' if self.is_stated else f'{ESTIMATED}: {within}'}{self.text}"


def main_dimensions(size: StatedSize) -> tuple[EstimatedValue, ...]:
    """Return breadth and draught [m]."""
    origin = "from length and mass" if size.mass else "from the length"
    form = size.form
    values = (
        ("B", size.beam, form.B, "breadth", BREADTH_ERROR), ("d", size.draught, form.d, "draught", _DRAUGHT_ERROR),
    )  # fmt: skip
    return tuple(
        EstimatedValue(key, given or rule, f"m, {name}, {'as stated' if given else origin}", bool(given), error)
        for key, given, rule, name, error in values
    )


def stated_values(size: StatedSize) -> tuple[EstimatedValue, ...]:
    """Return what is stated of hull and water besides the length, whether or not a model asks for it."""
    values = (
        EstimatedValue("B", size.beam, "m, breadth, as stated", bool(size.beam)),
        EstimatedValue("d", size.draught, "m, draught, as stated", bool(size.draught)),
        EstimatedValue("m", size.mass, "kg, as stated", bool(size.mass)),
        EstimatedValue("GM", size.gm, "m, metacentric height, as stated", bool(size.gm)),
    )
    return tuple(one for one in (*values, water_density(size)) if one.is_stated)


def _known_dimensions(size: StatedSize) -> int:
    """How many of breadth and draught are stated."""
    return bool(size.beam) + bool(size.draught)


def mass_properties(size: StatedSize) -> tuple[EstimatedValue, ...]:
    """Return mass, centre of gravity, inertia [SI] and water density of a ship of this size."""
    values = displacement(size.form, size.density).values
    text = f"kg, of a hull with {size.rules}; write the displacement if you know it (init --mass)"
    return (
        EstimatedValue("m", size.mass, "kg, as stated", is_stated=True)
        if size.mass
        else EstimatedValue("m", values["m"], text, error=_MASS_ERRORS[_known_dimensions(size)]),
        EstimatedValue("x_G", values["x_G"], "m forward of midship"),
        EstimatedValue("I_z", values["I_z"], "kg m^2, gyradius L/4 (Yasukawa & Yoshimura 2015)", error=_INERTIA_ERROR),
        water_density(size),
    )


def fullness(size: StatedSize) -> EstimatedValue:
    """Return the mass where it is stated, which it stays in water of any density; else the block coefficient."""
    if not size.mass:
        return EstimatedValue("C_b", size.form.C_b, "block coefficient")
    block = f"C_b {size.form.C_b:.{_DIGITS}g}, which follows from it with L, B, d and rho"
    return EstimatedValue("m", size.mass, f"kg, as stated: {block}", is_stated=True)


def water_density(size: StatedSize) -> EstimatedValue:
    """Return the density of the water [kg/m^3]: of sea water where it is not stated."""
    if size.rho:
        return EstimatedValue("rho", size.rho, "kg/m^3, as stated", is_stated=True)
    text = "kg/m^3, sea water; fresh water has 1000 (init --rho)"
    return EstimatedValue("rho", SEA_WATER, text, error=_WATER_ERROR)


def added_masses(size: StatedSize) -> tuple[EstimatedValue, ...]:
    """Return the acceleration derivatives over rho/2 L^3 and rho/2 L^5 of a ship of this size."""
    form = size.form
    estimate = added_mass(form)
    names = {"X_udot": "m_x_prime", "Y_vdot": "m_y_prime", "N_rdot": "J_z_prime"}
    outside = "" if estimate.valid else ", which this form is not"
    text = f"{ZHOU}, for {estimate.limits}{outside}; of other forms a guess"
    error = _ADDED_MASS_ERRORS[_known_dimensions(size) == 2]
    return tuple(
        EstimatedValue(key, -estimate.values[one] * form.d / form.L, text, error=error) for key, one in names.items()
    )


_DRIVING = "diameter of the propeller that drives such a hull at its rate: R_0 and t_P go with it"


def hull_rudder_propeller(
    size: StatedSize, speed: float, advance: float, screws: int = 1
) -> tuple[EstimatedValue, ...]:
    """Return what the MMG model needs besides the length, of a ship of `speed` [m/s] that makes `advance` [m] a turn.

    screws: one, or two with a rudder behind each; particulars are then those of one of them.

    Empty where no propeller under a hull of this draught makes so much or so little way in a turn, as where an engine
    is recorded and not its shaft, and where the hull is too fast for the formulas.
    """
    form = size.form
    if not (advance > 0.0 and 0.0 < speed < _FASTEST * math.sqrt(G * form.L)):
        return ()
    wake = interaction_wake(form) if screws == 1 else twin_screw_formulas(form.C_b, form.B, form.d, 0.0)["w_P0"]
    flow = advance * (1.0 - wake)  # m in a turn: J = u (1 - w) / (n D)
    smallest, largest = (share * form.d for share in _DIAMETERS)
    # thrust over rho n^2: (1 - t_P) rho n^2 D^4 K_T = rho/2 L d U^2 R_0, n = U / advance
    thrust = 0.5 * form.L * form.d * advance**2 * RESISTANCE / (1.0 - _thrust_deduction(form)) / screws
    diameter = size.propeller or min(max((thrust / _THRUST) ** 0.25, smallest), largest)
    if not _ADVANCES[0] <= flow / diameter <= _ADVANCES[1]:
        return ()
    pitch_ratio = _pitch_ratio(flow / diameter, thrust / diameter**4)
    # DNV rules for ships, part 3 chapter 14: least area of a rudder in the propeller's slipstream
    area = form.L * form.d / 100.0 * (1.0 + 50.0 * form.C_b**2 * (form.B / form.L) ** 2) / screws
    apart = EstimatedValue("y_P", _OFF_CENTRE * form.B, f"m, screws and rudders off the centre line: {_OFF_CENTRE:g} B")
    return (
        *main_dimensions(size),
        fullness(size),
        water_density(size),
        EstimatedValue("H_R", _SPAN * form.d, f"m, height of the rudder: {_SPAN:g} d"),
        EstimatedValue("A_R", size.rudder, "m^2, area of the rudder, as stated", is_stated=True)
        if size.rudder
        else EstimatedValue(
            "A_R", area, "m^2, area of the rudder: DNV's least area for L, B, d and C_b (init --rudder)"
        ),
        EstimatedValue("D_P", size.propeller, "m, diameter of the propeller, as stated", is_stated=True)
        if size.propeller
        else EstimatedValue("D_P", diameter, f"m, {_DRIVING} (init --propeller)"),
        EstimatedValue("pitch_ratio", pitch_ratio, "P/D with which it drives such a hull at its rate"),
        *([apart] if screws > 1 else []),
    )


def wind_areas(size: StatedSize) -> tuple[EstimatedValue, ...]:
    """Return the areas above water on which a recorded wind acts [m^2]."""
    form = size.form
    with_it = "the coefficients C_ of the wind go with it"
    return (
        EstimatedValue("A_T", _FRONTAL * form.B**2, f"m^2, frontal area above water: {_FRONTAL:g} B^2; {with_it}"),
        EstimatedValue("A_L", _LATERAL * form.L**2, f"m^2, lateral area above water: {_LATERAL:g} L^2; {with_it}"),
    )


def _thrust_deduction(form: HullForm) -> float:
    usual = USUAL_PROPELLER
    return propulsion(form, usual["pitch_ratio"], usual["area_ratio"], round(usual["blades"])).values["t_P"]


def _pitch_ratio(J: float, thrust: float) -> float:
    """Return the P/D with which a B series propeller has a thrust coefficient at an advance ratio, or comes nearest."""
    area_ratio, blades = USUAL_PROPELLER["area_ratio"], round(USUAL_PROPELLER["blades"])
    thrusts = [thrust_coefficient(np.array([J]), ratio, area_ratio, blades)[0] for ratio in _PITCH_RATIOS.tolist()]
    return float(_PITCH_RATIOS[np.argmin(np.abs(np.array(thrusts) - thrust))])


def _as_float(number: str) -> str:
    """The number as TOML writes a float."""
    return number if "." in number or "e" in number else f"{number}.0"


# Sizes of the craft and its speed that stand in the header of a text log.

# names of main dimensions in the headers of towing tanks and trial reports; a letter as it is, D is a diameter; ours
_NAMES = {
    "length": (r"L|(?i:L[ _]?pp|length(?: between perpendiculars)?)", "m"),
    "beam": (r"B|(?i:B[ _]?wl|beam|breadth)", "m"),
    "draught": (r"T|d|(?i:draught|draft)", "m"),
    "mass": (r"(?i:displ(?:acement|\.)|mass)", "kg"),
    "gm": (r"(?i:GM(?:[ _]?[0tT])?)", "m"),
    "rho": (r"(?i:rho|density|water)", "kg/m^3"),
}
_UNITS = {"m": "mm|cm|m", "kg": "kg|t", "kg/m^3": r"kg/m\^3|kg/m3"}
# the speed of a carriage or craft, as headers have it
_DECIMAL = r"\d+(?:\.\d+)?"
_SPEED = re.compile(rf"(?:(?i:speed)|(?<![\w.])V(?=[ \t]*[=:]))[ \t]*[=:]?[ \t]*({_DECIMAL})[ \t]*(m/s|kn)\b")
_SCALE = re.compile(rf"(?<![\d:])1\s?:\s?({_DECIMAL})(?![\d:])")


@dataclass(frozen=True)
class HeaderSize:
    """A size as a header has it, and the option of init that states it."""

    text: str
    option: str


def sizes_in_header(survey: LogSurvey, size: StatedSize) -> tuple[HeaderSize, ...]:
    """Return what the header of a text log says of the craft's size and what is not stated; nothing of other logs."""
    header = _header(survey)
    stated = {field.name for field in fields(size) if getattr(size, field.name)}
    sizes = tuple(one for name, one in _sizes(header).items() if name not in stated)
    place = header_statements(survey).get("antenna", HeaderStatement()).place
    if place is None or size.antenna is not None:
        return sizes
    return (
        *sizes,
        HeaderSize(f"antenna {abs(place):g} m {'forward' if place > 0.0 else 'aft'}", f"--antenna {place:g}"),
    )


def speed_in_header(survey: LogSurvey) -> float | None:
    """Return the speed [m/s] that the header of a text log states once; None where it states none."""
    matches = _SPEED.findall(_header(survey))
    if len(matches) != 1:
        return None
    number, unit = matches[0]
    return float(number) * si_unit(unit)[0]


# a side to which a quantity is positive, in words; a place forward or aft of midship
_TO_SIDE = {
    "bow up": r"(?:bow|nose)\W+up", "bow down": r"(?:bow|nose)\W+down", "up": r"up(?:wards?)?",
    "down": r"down(?:wards?)?", "port": r"port|left|counter-?clockwise|anti-?clockwise|ccw",
    "starboard": r"starboard|stbd|right|clockwise|cw",
}  # fmt: skip
_POSITIVE = r"(?:positive|pos\.|\+ve|\+)"
_ANTENNA = re.compile(r"antenna|receiver", re.IGNORECASE)
_PLACE = re.compile(
    rf"({_DECIMAL})\s*(mm|cm|m)\s+(?:(fwd|forward|ahead|before)|aft|abaft|behind|astern)", re.IGNORECASE
)
_LONGEST_SUBJECT, _SHORTEST_SUBJECT = 3, 3  # words, and letters, of a quantity in a sentence; ours


@dataclass(frozen=True)
class HeaderStatement:
    """What the header of a text log says of a quantity.

    Attributes:
        positive: the side to which it counts; empty: it is not said.
        place: where it is measured, m forward of midship; None: it is not said.
    """

    positive: str = ""
    place: float | None = None


def header_statements(survey: LogSurvey) -> dict[str, HeaderStatement]:
    """Return symbol -> what the sentences above the table of a text log say of it; ``antenna`` for that of a receiver.

    A clause without a quantity goes on about that of the clause before it. Several spaces end a sentence.
    """
    statements = dict[str, HeaderStatement]()
    sentences = re.split(r"[;\n\t]|\.\s|\s{2,}", _header(survey))
    for sentence in (text for text in sentences if _PLACE.search(text) or re.search(_POSITIVE, text, re.IGNORECASE)):
        symbol = ""
        for clause in sentence.split(","):
            symbol = _subject(clause) or symbol
            known = statements.get(symbol, HeaderStatement())
            place = _PLACE.search(clause)
            forward = float(place[1]) * si_unit(place[2])[0] * (1.0 if place[3] else -1.0) if place else known.place
            statement = HeaderStatement(_positive_side(clause) or known.positive, forward)
            statements |= {symbol: statement} if symbol and statement != HeaderStatement() else {}
    return statements


def _subject(clause: str) -> str:
    """The symbol of the longest name of a quantity in a clause; empty where there is none."""
    if _ANTENNA.search(clause):
        return "antenna"
    words = re.findall(r"[^\W\d_]+", clause)
    for count in range(_LONGEST_SUBJECT, 0, -1):
        for first in range(len(words) - count + 1):
            name = " ".join(words[first : first + count])
            guess = guess_by_name("", name, "") if len(name) >= _SHORTEST_SUBJECT else None
            if guess is not None:
                return guess.symbol
    return ""


def _positive_side(clause: str) -> str:
    """The side to which a clause says that a quantity is positive; empty where it says none."""
    for side, words in _TO_SIDE.items():
        behind = rf"{_POSITIVE}\W+(?:\w+\W+){{0,3}}?(?:{words})\b"
        if re.search(rf"{behind}|\b(?:{words})\W+(?:is\W+)?{_POSITIVE}", clause, re.IGNORECASE):
            return side
    return ""


def _header(survey: LogSurvey) -> str:
    """The lines above the numbers of a text log; empty of other logs, and where they are column names alone."""
    lines = survey.layout.header_lines if survey.layout.format == "text" else 0
    if lines < 2:  # a line of column names alone
        return ""
    try:
        return "\n".join(decoded_text(survey.path, survey.layout.encoding).splitlines()[:lines])
    except InputError:
        return ""


def _sizes(header: str) -> dict[str, HeaderSize]:
    """Each size that is named once in a header."""
    sizes = dict[str, HeaderSize]()
    for name, (words, unit) in _NAMES.items():
        pattern = rf"(?<![\w.])(?:{words})[ \t]*[=:]?[ \t]*(\d+(?:\.\d+)?)[ \t]*({_UNITS[unit]})\b"
        matches = list(re.finditer(pattern, header))
        if len(matches) == 1:
            value = float(matches[0][1]) * si_unit(UNIT_WORDS.get(matches[0][2], matches[0][2]))[0]
            sizes[name] = HeaderSize(" ".join(matches[0][0].split()), f"--{name} {value:g}")
    scales = list(_SCALE.finditer(header))
    if len(scales) == 1:
        sizes["scale"] = HeaderSize(scales[0][0], f"--scale {float(scales[0][1]):g}")
    return sizes


# Whether logs are of a free-running model in a basin, where no current runs and one model has one rudder zero.

_OFTEN_FRESH = 12.0  # m, of the craft that are tried on lakes and in basins; chosen
_LONGEST_MODEL = 10.0  # m; chosen: the largest free-running models of ships have 7 to 8
_SATELLITES = frozenset({"lat", "lon", "sog", "cog"})  # what a receiver of satellites logs


def is_in_basin(guesses: Iterable[ColumnGuess], size: StatedSize) -> bool:
    """Return whether a craft is a model whose place was measured from the shore: x0, y0, and nothing of a receiver.

    guesses: of all sources of a run, used or not.
    """
    known = list(guesses)
    is_model = size.scale > 1.0 or 0.0 < size.length < _LONGEST_MODEL
    has_track = any(one.symbol == "x0" and one.is_used and one.frame != "enu" for one in known)
    is_over_ground = any(one.is_used and one.symbol == "u" and one.frame in ("earth", "enu") for one in known)
    return is_model and has_track and not is_over_ground and not any(one.symbol in _SATELLITES for one in known)


def may_be_in_fresh_water(size: StatedSize) -> bool:
    """Return whether a craft of this size is often tried in fresh water, and the density is not stated."""
    return not size.rho and (size.scale > 1.0 or 0.0 < size.length < _OFTEN_FRESH)
