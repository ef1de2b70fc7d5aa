"""What a column may be, by its name: the messages of known loggers first, then the names that people use."""

import re
import unicodedata
from collections.abc import Iterable, Mapping, Sequence, Set
from dataclasses import dataclass, replace

from seatrial.core.text.words import enumeration
from seatrial.core.values import InputError, si_unit, spelling_hint
from seatrial.core.values.notation import UNIT_WORDS
from seatrial.data.draft.stored_parameters import PX4_MAIN_OUTPUTS
from seatrial.data.read.layout import log_quantity

# Headings of logs in other languages of seafarers, as the English names that a draft knows.

_HEADINGS = {
    "time": "tid tidspunkt klokke klokken klokkeslett klokkeslet klockslag zeit uhrzeit zeitstempel tijd tijdstip "
            "heure temps horodatage hora tiempo ora orario tempo",
    "date": "dato datum fecha data",
    "latitude": "bredde breddegrad latitud breite breitengrad breedte breedtegraad latitudine",
    "longitude": "lengde lengdegrad laengde laengdegrad langd longitud laenge lange langengrad laengengrad lengte "
                 "lengtegraad longitudine",
    "speed_over_ground": "fart_over_grunn fart_over_bunn hastighet_over_grunn fart_over_grund hastighed_over_grund "
                         "fahrt_uber_grund fahrt_ueber_grund geschwindigkeit_uber_grund geschwindigkeit_ueber_grund "
                         "fug grondsnelheid snelheid_over_de_grond vitesse_fond vitesse_sur_le_fond "
                         "velocidad_sobre_el_fondo velocidad_sobre_fondo velocita_sul_fondo velocidade_sobre_o_fundo",
    "course_over_ground": "kurs_over_grunn kurs_over_grund kurs_uber_grund kurs_ueber_grund kug grondkoers "
                          "koers_over_de_grond route_fond route_sur_le_fond rumbo_sobre_el_fondo rumbo_sobre_fondo "
                          "rotta_sul_fondo rumo_sobre_o_fundo",
    "speed_through_water": "fart_gjennom_vann fart_gjennom_vannet fart_gennem_vand fart_genom_vattnet "
                           "fart_genom_vatten fahrt_durchs_wasser fahrt_durch_das_wasser fdw "
                           "snelheid_door_het_water vitesse_surface velocidad_respecto_al_agua",
    "heading": "kurs stevning styrekurs gyrokurs steuerkurs vorausrichtung koers cap cap_vrai rumbo rumbo_verdadero "
               "proa prua prora aproamento",
    "compass": "kompass kompasskurs kompas kompaskurs kompaskoers cap_compas",
    "rate_of_turn": "svinghastighet girrate girehastighet drejehastighed svanghastighet girhastighet drehrate "
                    "drehgeschwindigkeit wendegeschwindigkeit gierrate giergeschwindigkeit draaisnelheid "
                    "vitesse_de_giration taux_de_giration vitesse_de_lacet velocidad_de_giro velocidad_de_guinada "
                    "velocita_di_accostata velocita_di_imbardata taxa_de_guinada",
    "rudder_angle": "ror rorvinkel roder rodervinkel roderlage rorlage ruder ruderwinkel ruderlage roer roerhoek "
                    "roerstand barre angle_de_barre safran timon angulo_de_timon angulo_del_timon timone "
                    "angolo_timone angolo_di_barra leme angulo_do_leme",
    "shaft_rpm": "turtall omdreininger propellerturtall varvtal propellervarvtal omdrejningstal omdrejninger drehzahl "
                 "wellendrehzahl propellerdrehzahl toerental omwentelingen tours_minute regime_helice "
                 "regime_ligne_d_arbre revoluciones giri giri_elica numero_di_giri rotacoes",
    "engine_speed": "maskinturtall motorturtall motorvarvtal motordrehzahl motortoerental regime_moteur "
                    "revoluciones_del_motor giri_motore",
    "roll": "rull rulling rullevinkel krengning krangning rullning kraengning rulning krengningsvinkel slagside "
            "rollwinkel krangung rolhoek helling roulis gite balanceo escora rollio sbandamento balanco",
    "roll_rate": "rullhastighet rullehastighet rollrate rollgeschwindigkeit rolsnelheid vitesse_de_roulis",
    "pitch": "stamping stampvinkel nickwinkel stampfwinkel stampning stamphoek tangage cabeceo beccheggio "
             "arfagem",
    "heave": "hiv hivning havning tauchbewegung dompen pilonnement sussulto",
}  # fmt: skip
_ENGLISH = {word: english for english, words in _HEADINGS.items() for word in words.split()}
# letters that do not come apart into a letter and its accent
_LETTERS = str.maketrans({"ø": "o", "æ": "ae", "ß": "ss", "œ": "oe", "ł": "l", "đ": "d"})


def without_accents(text: str) -> str:
    """Return a text in small letters, without accents."""
    apart = unicodedata.normalize("NFKD", text.lower().translate(_LETTERS))
    return "".join(letter for letter in apart if not unicodedata.combining(letter))


def plain_name(name: str) -> str:
    """Return a heading in small letters and figures without accents, with a line between words."""
    return re.sub(r"[^a-z0-9]+", "_", without_accents(name)).strip("_")


def in_english(plain: str) -> str:
    """Return the English heading of a plain one in another language; as it is where it is not known.

    plain: small letters without accents, words joined by underscores.
    """
    return _ENGLISH.get(plain, plain)


# What a column may be, by its name: the messages of known loggers first, then the names that people use.

_SCALED_DEGREE = 1e-7  # MAVLink and PX4: degrees as integers

_ENGINE = "rate of the engine: to use it, write it as channels.n with scale = propeller turns over engine turns"
_AUXILIARY = "command_{} of AUX"  # the outputs of PX4's second bank, which are counted on from those of the first


@dataclass(frozen=True)
class NameRule:
    """A pattern of ``topic/field`` (small letters) and what it names; an empty unit is to be found by behaviour.

    unused_because: why a column of this name is not taken by itself. note: what else is to be known of one.
    other_reading: what it may be as well.
    """

    pattern: str
    symbol: str
    unit: str = ""
    frame: str = ""
    positive: str = ""
    scale: float = 1.0
    unused_because: str = ""
    note: str = ""
    logger: str = ""
    other_reading: str = ""


def _rules(logger: str, *rows: tuple) -> list[NameRule]:
    """Rules of one logger: pattern, symbol, unit, then frame, positive and scale where they are stated."""
    return [replace(NameRule(*row), logger=logger) for row in rows]


_MESSAGES = [
    *_rules(
        "ArduPilot",
        (r"(xkf1|nkf1)(\[0\])?/vn", "u", "m/s", "earth"), (r"(xkf1|nkf1)(\[0\])?/ve", "v", "m/s", "earth"),
        (r"(xkf1|nkf1)(\[0\])?/pn", "x0", "m"), (r"(xkf1|nkf1)(\[0\])?/pe", "y0", "m"),
        (r"(att|xkf1\[0\]|xkf1|nkf1)/yaw", "psi", "deg"), (r"(att|xkf1\[0\]|xkf1|nkf1)/roll", "phi", "deg"),
        (r"(att|xkf1\[0\]|xkf1|nkf1)/pitch", "theta", "deg"), (r"imu(\[0\])?/gyrz", "r", "rad/s"),
        (r"imu(\[0\])?/gyrx", "p", "rad/s"), (r"gps(\[0\])?/lat", "lat", "deg"), (r"gps(\[0\])?/lng", "lon", "deg"),
        (r"gps(\[0\])?/spd", "sog", "m/s"), (r"gps(\[0\])?/gcrs", "cog", "deg"), (r"bat(\[0\])?/volt", "voltage", "V"),
        (r"rcou/c(\d+)", "command_{}", "us"),
    ),
    *_rules(
        "MAVLink",
        (r"attitude/yaw", "psi", "rad"), (r"attitude/roll", "phi", "rad"), (r"attitude/pitch", "theta", "rad"),
        (r"attitude/yawspeed", "r", "rad/s"), (r"attitude/rollspeed", "p", "rad/s"),
        (r"local_position_ned/x", "x0", "m"), (r"local_position_ned/y", "y0", "m"),
        (r"local_position_ned/vx", "u", "m/s", "earth"), (r"local_position_ned/vy", "v", "m/s", "earth"),
        (r"global_position_int/lat", "lat", "deg", "", "", _SCALED_DEGREE),
        (r"global_position_int/lon", "lon", "deg", "", "", _SCALED_DEGREE),
        (r"servo_output_raw/servo(\d+)_raw", "command_{}", "us"),
    ),
    *_rules(
        "PX4",
        (r"vehicle_local_position/x", "x0", "m"), (r"vehicle_local_position/y", "y0", "m"),
        (r"vehicle_local_position/heading", "psi", "rad"), (r"battery_status(\[0\])?/voltage_v", "voltage", "V"),
        (r"vehicle_local_position/vx", "u", "m/s", "earth"), (r"vehicle_local_position/vy", "v", "m/s", "earth"),
        (r"vehicle_attitude/q\[0\]", "q_w", "1"), (r"vehicle_attitude/q\[1\]", "q_x", "1"),
        (r"vehicle_attitude/q\[2\]", "q_y", "1"), (r"vehicle_attitude/q\[3\]", "q_z", "1"),
        (r"vehicle_angular_velocity/xyz\[2\]", "r", "rad/s"), (r"vehicle_angular_velocity/xyz\[0\]", "p", "rad/s"),
        (r"vehicle_gps_position/lat", "lat", "deg", "", "", _SCALED_DEGREE),
        (r"vehicle_gps_position/lon", "lon", "deg", "", "", _SCALED_DEGREE),
        (r"actuator_outputs(\[0\])?/output\[(\d+)\]", "command_{}", "us"),
        (r"actuator_outputs\[1\]/output\[(\d+)\]", _AUXILIARY, "us"),
    ),
    *_rules(
        "NMEA 0183",
        (r"(gga|rmc|gns|gll)/lat", "lat", "rad"), (r"(gga|rmc|gns|gll)/lon", "lon", "rad"),
        (r"(vtg|rmc)/speed", "sog", "m/s"), (r"(vtg|rmc)/course", "cog", "rad"),
        (r"(hdt|ths|osd|pashr)/heading|(hdg|hdm)/true|vhw/heading", "psi", "rad"), (r"rot/rate", "r", "rad/s"),
        (r"hdm/heading|(hdg|vhw)/magnetic", "psi_magnetic", "rad"),
        (r"rsa/angle|rsa/port|xdr/(rudder|helm).*", "delta", "rad"), (r"(vhw|vbw|osd)/speed", "stw", "m/s"),
        (r"rpm/s(\d)", "rpm_{}", "rps"),
        (r"rpm/e\d", "n", "rps", "", "", 1.0, _ENGINE),
        (r"(mwv|vwr)/speed", "wind_speed_relative", "m/s"), (r"(mwv|vwr)/angle", "wind_direction_relative", "rad"),
        (r"mwd/speed", "wind_speed", "m/s"), (r"mwd/direction", "wind_direction", "rad"),
        (r"(xdr|pashr)/(roll|heel)", "phi", "rad"), (r"(xdr|pashr)/(ptch|pitch)", "theta", "rad"),
        (r"(xdr|pashr)/heave?", "z", "m"),
    ),
    *_rules(
        "NMEA 2000",
        (r"positionrapidupdate(@\d+)?/latitude", "lat", "deg"), (r"positionrapidupdate(@\d+)?/longitude", "lon", "deg"),
        (r"cogsograpidupdate:true(@\d+)?/cog", "cog", "rad"), (r"cogsograpidupdate(:\w+)?(@\d+)?/sog", "sog", "m/s"),
        (r"rateofturn(@\d+)?/rate", "r", "rad/s"), (r"vesselheading:true(@\d+)?/heading", "psi", "rad"),
        (r"vesselheading:magnetic(@\d+)?/heading", "psi_magnetic", "rad"),
        (r"attitude(@\d+)?/yaw", "psi", "rad"),
        (r"attitude(@\d+)?/roll", "phi", "rad"),
        (r"attitude(@\d+)?/pitch", "theta", "rad"), (r"speed(@\d+)?/speedwaterreferenced", "stw", "m/s"),
        (r"rudder(:\w+)?(@\d+)?/position", "delta", "rad"), (r"heave(@\d+)?/heave", "z", "m", "", "up"),
        (r"engineparametersrapidupdate(:\w+)?(@\d+)?/speed", "n", "rpm"),
    ),
    *_rules(
        "ROS",
        (r".*pose\.orientation\.w", "q_w", "1", "enu"), (r".*pose\.orientation\.x", "q_x", "1", "enu"),
        (r".*pose\.orientation\.y", "q_y", "1", "enu"), (r".*pose\.orientation\.z", "q_z", "1", "enu"),
        (r".*pose\.position\.x", "x0", "m", "enu"), (r".*pose\.position\.y", "y0", "m", "enu"),
        (r"([^/]*/)*(pose|position|pose2d)/x", "x0", "m", "enu"),
        (r"([^/]*/)*(pose|position|pose2d)/y", "y0", "m", "enu"),
        (r"([^/]*/)*(pose|position|pose2d)/theta", "psi", "rad", "enu"),
        (r".*pose_orientation_w", "q_w", "1", "enu"), (r".*pose_orientation_x", "q_x", "1", "enu"),
        (r".*pose_orientation_y", "q_y", "1", "enu"), (r".*pose_orientation_z", "q_z", "1", "enu"),
        (r".*pose_position_x", "x0", "m", "enu"), (r".*pose_position_y", "y0", "m", "enu"),
        (r".*twist_body/twist_linear_x", "u", "m/s", "body"),
        (r".*twist_body/twist_linear_y", "v", "m/s", "body", "port"),
        (r".*twist_body/twist_angular_z", "r", "rad/s", "", "port"),
        (r".*(actuator|thruster|motor)_(\d+)/azimuth_angle/data", "alpha_{}"),
        (r".*(actuator|thruster|motor)_(\d+)/(.*/)?(motor_speed|rpm)", "rpm_{}"),
        (r".*twist\.linear\.x", "u", "m/s", "body"), (r".*twist\.linear\.y", "v", "m/s", "body", "port"),
        (r".*twist\.angular\.z", "r", "rad/s", "", "port"),
    ),
]  # fmt: skip
_FORWARD, _ACROSS = "(forward|fwd|ahead|longitudinal)", "(stbd|starboard|lateral|transverse)"
_COMPASS = "a magnetic one is psi_magnetic, with variation"
_RATE = "taken for the shaft's; of an engine behind a gear add scale = propeller turns over engine turns"
# what a heading of the wind holds: the wind, the apparent or the true one, its speed, where it comes from
_AIR = "(?=(.*_)?(wind(?!ow|lass)|vind|viento|vento|vent_))"
_IS_APPARENT = "(?=.*(app|rel|schein|schijn|skenbar))"
_IS_TRUE = "(?=.*(true|wahr|vrai|real|verdader|sann|abs|_t(_|$)))"
_FAST = "(speed|spd|velo|geschw|hastig|vitesse|snelheid)"
_FROM = "(dir|ang(le)?|richt|retning|riktning|rumbo)"
APPARENT_WIND = "the apparent wind, if so called wind_speed_relative, wind_direction_relative"
"""The other reading of a wind whose heading says neither true nor apparent."""
_PROBE = "counts as at midship; of a probe on the craft elsewhere add reference_point, m forward of midship"
_PORT, _STARBOARD = "(left|port)", "(right|starboard|stbd)"
# letters of thrusters, as in motor_l
_SIDE_LETTERS = {"port": re.compile("(^|_)l($|_)"), "starboard": re.compile("(^|_)r($|_)")}
_SIDES = {"port": _PORT, "starboard": _STARBOARD}
_SIDE = f"({_PORT}|{_STARBOARD})"
_TWO_RUDDERS = "of rudders that move together one is read: A_R is the area of all"
# thrust goes with D^4 at one rate and advance: two propellers thrust as one that is the fourth root of two as large
_TWO_SCREWS = "of screws that turn together one is read; in mmg D_P times 1.19 stands for two"
_THRUSTER = "(thr(ottle|ust|uster)?s?|motors?|esc|pwm|command|cmd)"
_PULSE = "(_(pwm|us|out|output|raw|cmd|command|thrust))*"
_WORDS = [
    *_rules(
        "",
        (r"(position_)?lat(itude)?", "lat", ""), (r"(position_)?lon(gitude)?|lng", "lon", ""),
        (r"sog|speed_over_ground|ground_?speed|(gps|gnss)\d*_(speed|spd)|spd", "sog", ""),
        (r"cog|course(_over_ground)?|(gps|gnss)\d*_(heading|course|track)|gcrs", "cog", ""),
        (r"stw|speed_through_water|log_speed|boat_?speed", "stw", ""),
        (r"(magnetic_)?variation", "variation", ""),
        (r"(set|ordered|desired|target)_(heading|course)", "psi_ref", ""),
        (r"hdm|mag(netic)?_heading|heading_mag(netic)?", "psi_magnetic", ""),
        (r"compass(_heading)?|gyro(_?compass)?", "psi", "", "", "", 1.0, "", _COMPASS),
        (r"((true|course|kurs|koers|cap|rumbo)_)?(heading|hdg|hdt)|psi|psi_hat|yaw|yaw_angle", "psi", ""),
        (r"turn(ing)?_rate|rate_of_turn|rot", "r", ""),
        (r"yaw_?rate|yaw_?speed|r|r_angvelo|gyro?_?z|angular_velocity_z", "r", ""),
        (r"x_ned|x_?north|north(ing)?|north_x|x0|pos(ition)?_n(orth)?", "x0", "", "earth"),
        (r"y_ned|y_?east|east(ing)?|east_y|y0|pos(ition)?_e(ast)?", "y0", "", "earth"),
        (r"x_position(_mid)?|x", "x0", ""), (r"y_position(_mid)?|y", "y0", ""),
        (r"surge(_speed|_velocity)?|u_velo", "u", "", "body"), (r"sway(_speed|_velocity)?|vm?_velo", "v", "", "body"),
        (rf"{_FORWARD}_(speed|velocity)|(speed|velocity)_{_FORWARD}", "u", "", "body"),
        (rf"{_ACROSS}_(speed|velocity)|(speed|velocity)_{_ACROSS}", "v", "", "body"),
        (r"v(el)?_?n(orth)?|vel_north", "u", "", "earth"), (r"v(el)?_?e(ast)?|vel_east", "v", "", "earth"),
        (r"u", "u", ""), (r"v", "v", ""), (r"surge_(dot|acc(eleration)?)", "u_dot", "", "body"),
        (r"sway_(dot|acc(eleration)?)", "v_dot", "", "body"),
        (r"rudder(_(angle|pos(ition)?|feedback|act(ual)?))?|rud|delta(_rudder)?|rsa|helm|nozzle(_angle)?", "delta", ""),
        (r"(steer(ing)?|outboard|azimuth)(_(angle|pos(ition)?|feedback))?", "delta", ""),
        (r"throttle", "command_1", ""), (r"alpha_(\d+)", "alpha_{}", ""),
        (r"(main_|port_|stbd_)?eng(ine)?(_(rate|speed|revs?))?", "n", "", "", "", 1.0, _ENGINE),
        (r"n_prop|(prop(eller)?|shaft)_(rate|rpm|rps|revs?|speed)|(prop(eller)?|shaft)", "n", ""),
        (r"rpm|rps|n", "n", "", "", "", 1.0, "", _RATE),
        (rf"rudder_{_SIDE}|{_SIDE}_rudder", "delta", "", "", "", 1.0, "", _TWO_RUDDERS),
        (rf"(rpm|(prop(eller)?|shaft)(_rpm|_speed)?)_{_SIDE}|{_SIDE}_(rpm|(prop(eller)?|shaft)(_rpm|_speed)?)",
         "n", "", "", "", 1.0, "", _TWO_SCREWS),
        (r"roll(_angle)?|phi|heel", "phi", ""), (r"pitch(_angle)?|theta|trim_angle", "theta", ""),
        (r"roll_rate|p", "p", ""), (r"heave|z", "z", ""),
        (
            r"zeta|wave(_(probe|gauge|height|elevation))?|(free_)?surface_elevation",
            "zeta", "", "", "", 1.0, "", _PROBE,
        ),
        (r"(batt?(ery)?_?)?volt(s|age)?|batt?(ery)?(_v)?|v_?batt?(ery)?", "voltage", ""),
        (rf"{_THRUSTER}_?{_PORT}{_PULSE}|{_PORT}_?{_THRUSTER}{_PULSE}", "command_1", ""),
        (rf"{_THRUSTER}_?{_STARBOARD}{_PULSE}|{_STARBOARD}_?{_THRUSTER}{_PULSE}", "command_2", ""),
        (rf"{_THRUSTER}_l{_PULSE}|l_{_THRUSTER}{_PULSE}", "command_1", ""),
        (rf"{_THRUSTER}_r{_PULSE}|r_{_THRUSTER}{_PULSE}", "command_2", ""),
        (rf"({_THRUSTER}|servo)_?(\d+){_PULSE}", "command_{}", ""),
        (rf"c\d+_{_PORT}", "command_1", ""), (rf"c\d+_{_STARBOARD}", "command_2", ""),
        (rf"{_AIR}{_IS_APPARENT}.*{_FAST}.*", "wind_speed_relative"), (r"aws", "wind_speed_relative"),
        (rf"{_AIR}{_IS_APPARENT}.*{_FROM}.*", "wind_direction_relative"), (r"awa", "wind_direction_relative"),
        (rf"{_AIR}{_IS_TRUE}.*{_FAST}.*", "wind_speed"), (r"tws", "wind_speed"),
        (rf"{_AIR}{_IS_TRUE}.*{_FROM}.*", "wind_direction"), (r"twd", "wind_direction"),
        (rf"{_AIR}.*{_FAST}.*", "wind_speed", "", "", "", 1.0, "", "", "", APPARENT_WIND),
        (rf"{_AIR}.*{_FROM}.*", "wind_direction", "", "", "", 1.0, "", "", "", APPARENT_WIND),
    ),
]  # fmt: skip
# words of topics that hold orders or limits, not measurements
_ORDERS = re.compile(r"set_?point|target|desired|reference|goal|limits?\b|cmd|command|(^|/)[re]_")
# loggers whose messages are all known: other messages say nothing
_KNOWN_LOGGERS = ("ulog", "ardupilot-bin", "ardupilot-tlog", "nmea0183", "nmea2000")
# column of a table into which an autopilot's log was exported: ``ATT.Yaw``, ``XKF1[0].VN``
_EXPORTED = re.compile(r"/?([A-Za-z]\w*(?:\[\d+\])?)[./](\w+(?:\[\d+\])?)")
_ONLY_FIELD, _TOPIC_PARTS = "data", 3  # of ROS's std_msgs; names of folders before that of a topic that are read
# words before a quantity that name an instrument, and words behind it that say how it was taken
_INSTRUMENT = re.compile(r"(d?gps|gnss|rtk|imu|ahrs|ins|mru|gyro|vdr|nav|nmea|ais|doppler|dvl|sensor|ship|vessel)\d*_")
_QUALIFIERS = re.compile(
    r"(_(true|t|filt(ered)?|meas(ured)?|actual|raw|avg|mean|value|deg_t|lcg|cg|mid(ships?)?|amidships|\d"
    r"|gyro|d?gps|gnss|rtk|ins|imu|rw|rechtweisend|wahrer?|ist(wert)?|faktisk|vrai|verdadero))+$"
)
# between the words of a name that sets them apart by capitals: RudderAngle, ShaftRPM
_CAPITALS = re.compile(r"(?<=[a-z0-9])(?=[A-Z])|(?<=[A-Z])(?=[A-Z][a-z])")
# of motions: a heading of another of these than a channel has means another quantity
_MOTION_UNITS = frozenset({"m", "m/s", "m/s^2", "rad", "rad/s"})
# degrees behind a heading, from true or magnetic north, or a rate; the serial number of the instrument before them
_DEGREES, _SERIAL = re.compile(r"\s*°([MT]?)(/s|/min)?(?:ec)?$"), re.compile(r"\s\d{6}#?\s*$")
_BRACKETS = re.compile(r"[\[(]([^\])]*)[\])]")


@dataclass(frozen=True)
class NameGuess:
    """What the name of a column says.

    Attributes:
        rule: what it names.
        symbol: with the number of a thruster filled in.
        unit: stated by the file, by the name, or by the logger's documentation; empty: not known.
        evidence: for people.
        side: of the craft, port or starboard, that it names; empty: none.
    """

    rule: NameRule
    symbol: str
    unit: str
    evidence: str
    side: str = ""


def guess_by_name(topic: str, name: str, stated_unit: str, log_format: str = "text") -> NameGuess | None:
    """Return what a column is by its name, None where the name says nothing.

    Messages of autopilots and buses are known one by one; of other topics of orders those of thrusters count.
    stated_unit: the unit that the file states; it overrides what the name says.
    """
    exported = _EXPORTED.fullmatch(name) if log_format == "text" else None
    message, field = exported.groups() if exported else (topic, name)
    for rule in _MESSAGES if message else ():
        match = re.fullmatch(rule.pattern, f"{message}/{field}".lower())
        if match:
            last = message.rpartition("/")[2] if log_format == "text" else message  # not the folders of a user
            return _guess(rule, match, _known_unit(stated_unit) or rule.unit, f"{rule.logger} {last}".strip())
    if field == _ONLY_FIELD and (command := command_of_topic(topic, _known_unit(stated_unit))):
        return command
    last = topic if log_format != "text" else topic.rpartition("/")[2]  # folders are called as anybody likes
    if log_format in _KNOWN_LOGGERS:
        return None
    names = [word for word in _WORDS if word.symbol.startswith("command_")] if _ORDERS.search(last.lower()) else _WORDS
    degrees = _DEGREES.search(name)
    unit = _known_unit(stated_unit) or bracketed_unit(name) or (f"deg{degrees[2] or ''}" if degrees else "")
    bare = _SERIAL.sub("", _BRACKETS.sub("", name[: degrees.start()] if degrees else name))
    for text, word_unit in (*_readings(plain_name(bare)), *_readings(plain_name(_CAPITALS.sub("_", bare)))):
        for rule in names:
            match = re.fullmatch(rule.pattern, in_english(text))
            guess = _guess(rule, match, unit or word_unit, "its name") if match else None
            if guess is not None and (guess.unit or not word_unit):  # not heave for a ``z`` in rad/s
                return _from_magnetic_north(guess) if degrees and degrees[1] == "M" else guess
    return None


def _from_magnetic_north(guess: NameGuess) -> NameGuess | None:
    """The heading from magnetic north; a course from there is none that is read."""
    return replace(guess, symbol="psi_magnetic") if guess.symbol == "psi" else None


def command_of_topic(topic: str, unit: str = "") -> NameGuess | None:
    """Return what the only field of a message is whose topic is called after a thruster, as ``thrusters/left/cmd``."""
    parts = [plain_name(_CAPITALS.sub("_", part)) for part in topic.split("/")]
    for count in range(1, _TOPIC_PARTS + 1):
        name = "_".join(parts[-count:])
        for rule in _WORDS:
            match = re.fullmatch(rule.pattern, name) if rule.symbol.startswith("command_") else None
            if match:
                return _guess(rule, match, unit, f"its topic {parts[-1]}")
    return None


def bracketed_unit(name: str) -> str:
    """Return the unit that stands in brackets in a heading; empty where none does."""
    return next((known for text in _BRACKETS.findall(name) if (known := _known_unit(text))), "")


def _readings(plain: str) -> list[tuple[str, str]]:
    """A name with the unit behind it: as it is, then without what only says from where it comes."""
    heads = [plain]
    while instrument := _INSTRUMENT.match(heads[-1]):
        heads.append(heads[-1][instrument.end() :])
    names = list(dict.fromkeys(name for head in heads for name in (head, _QUALIFIERS.sub("", head)) if name))
    whole = [reading for name in names for reading in _with_unit_word(name)]
    cut = ((_QUALIFIERS.sub("", name), unit) for name, unit in whole if unit)
    return [*whole, *(reading for reading in cut if reading not in whole and reading[0])]


def _with_unit_word(plain: str) -> list[tuple[str, str]]:
    """The name as it is, and without its last word or two where they are a unit (``yaw_rate_deg_s``: deg/s)."""
    words = plain.split("_")
    ends = ((words[:-count], "/".join(words[-count:])) for count in (2, 1) if len(words) > count)
    return [(plain, ""), *(("_".join(head), UNIT_WORDS[end]) for head, end in ends if end in UNIT_WORDS)]


def _guess(rule: NameRule, match: re.Match[str], unit: str, evidence: str) -> NameGuess | None:
    symbol = rule.symbol
    if "{}" in symbol:
        number = int(next(part for part in match.groups() if part and part.isdecimal())) + (rule.logger == "PX4")
        if symbol == _AUXILIARY:
            symbol, number = "command_{}", number + PX4_MAIN_OUTPUTS
        symbol = symbol.format(max(number, 1))
    try:
        expected = log_quantity(symbol).unit
    except InputError:
        return None
    is_share = symbol == "delta" and unit == "percent"
    if unit and unit != "us" and not is_share and si_unit(unit)[1] != expected:
        if not rule.logger and {si_unit(unit)[1], expected} <= _MOTION_UNITS:
            return None  # ``Gyro X (deg/s)`` is no position, although it ends in x
        unit = ""
    side = named_side(match.string)
    if not side and symbol.startswith("command_"):
        side = next((one for one, letter in _SIDE_LETTERS.items() if letter.search(match.string)), "")
    return NameGuess(rule, symbol, unit, evidence, side)


def named_side(name: str) -> str:
    """Return the side of the craft that a heading names, port or starboard; empty where it names none."""
    return next((word for word, names in _SIDES.items() if re.search(names, name.lower())), "")


def _known_unit(text: str) -> str:
    word = text.strip().lower()
    if word in UNIT_WORDS:
        return UNIT_WORDS[word]
    try:
        si_unit(text.strip())
    except InputError:
        return ""
    return text.strip()


# Columns whose meaning is stated: the name of each, as the log has it, and what it is.

StatedColumns = Mapping[str, str]
"""Heading of a column -> ``time``, or a channel or name that a draft knows, such as ``psi`` or ``heading``."""
TIME = "time"
CHANNELS = "lat, lon, sog, cog, psi, r, u, v, delta, n, phi, theta, z, zeta, command_1"
"""Channels that logs hold most often."""
NOTHING_STATED: StatedColumns = {}


def stated_columns(texts: Iterable[str]) -> dict[str, str]:
    """Return what texts such as ``Klokke=time`` state, the heading before the last equals sign.

    Raises:
        InputError: a text without an equals sign, a heading stated twice, or a meaning that a draft does not know.
    """
    stated = dict[str, str]()
    for text in texts:
        heading, equals, meaning = (part.strip() for part in text.rpartition("="))
        if not equals or not heading or not meaning:
            raise InputError(f"--column '{text}': write HEADING=CHANNEL, as in --column 'Klokke=time'")
        if heading in stated:
            raise InputError(f"--column '{text}': the column '{heading}' is stated twice; state it once")
        if meaning != TIME and guess_by_name("", meaning, "") is None:
            raise InputError(
                f"--column '{text}': '{meaning}' is no channel that a log can hold; known are {TIME}, {CHANNELS}"
            )
        stated[heading] = meaning
    return stated


def refuse_absent(stated: StatedColumns, headings: Iterable[str]) -> None:
    """Refuse a stated column that no log has.

    Raises:
        InputError: there is one; the heading most like it is named.
    """
    known = list(dict.fromkeys(headings))
    for heading in stated:
        if heading not in known:
            raise InputError(f"--column '{heading}=...': no log has this column{spelling_hint(heading, known)}")


# Columns that are known and that no draft takes, with the reason: others say the same, or they show no motion.

_UNIT = re.compile(r"\[.*?\]|\(.*?\)")  # in brackets behind a heading
_NAMES_SHOWN = 4  # columns of one reason that a line names; ours
_PLACES = frozenset({"lat", "x0"})
_ANGLES = frozenset({"delta", "alpha_1"})
_UNNEEDED_HEADINGS = frozenset({"psi"})
_ROLL = frozenset({"phi"})
_ORDERED = "order(ed)?|command(ed)?|cmd|demand(ed)?|set_?point|target|desired"


@dataclass(frozen=True)
class _Rule:
    """A pattern of names in small letters, and why they are not needed.

    beside: channels of which one is used where that holds; empty: it holds always.
    """

    pattern: str
    reason: str
    beside: frozenset[str] = frozenset()


# messages of MAVLink, common.xml, as topic/field
_UNNEEDED_MESSAGES = (
    _Rule(r"global_position_int/v[xy]|vfr_hud/groundspeed", "the positions show the speed over ground", _PLACES),
    _Rule(
        r"global_position_int/hdg|vfr_hud/heading|gps\d?_raw(_int)?/yaw",
        "another column has the heading",
        _UNNEEDED_HEADINGS,
    ),
    _Rule(r"gps\d?_raw(_int)?/(lat|lon|vel|cog)", "of the receiver alone; the estimated position is used", _PLACES),
    _Rule(r"vfr_hud/throttle", "the mean of the outputs, each of which is known", frozenset({"command_1"})),
    _Rule(r"servo_output_raw/servo\d+_raw", "an output that does not change, or is disabled"),
    _Rule(r"(vtg|rmc)/(north|east)", "speed and course over ground show them", frozenset({"sog"})),
    _Rule(r"(rmc|hdg)/variation|(hdm|hdg|vhw)/(heading|magnetic)", "the true heading holds them", _UNNEEDED_HEADINGS),
    _Rule(r"(dpt|dbt|dbs|dbk)/depth", "no model takes a depth that changes"),
    _Rule(r"attitude/pitchspeed", "no model in the plane takes it"),
    _Rule(r"\w+/((relative_)?alt|alt_ellipsoid|vz|climb|airspeed)", "height and air: no model in the plane takes them"),
    _Rule(r"\w+/time_(boot_ms|usec)", "the log has stamps of its own"),
    _Rule(
        r"(sys_status|power_status|heartbeat|meminfo|system_time|timesync)/\w+|servo_output_raw/port|"
        r"gps\d?_raw(_int)?/(fix_type|eph|epv|satellites_visible|(h|v|vel|hdg)_acc)",
        "the state of autopilot and receiver",
    ),
)
# what people call columns of a table
_UNNEEDED_WORDS = (
    _Rule(rf"(rudder|helm|steering|nozzle)_(angle_)?({_ORDERED})", "an order; the angle that follows is used", _ANGLES),
    _Rule(rf"({_ORDERED})_(rudder|helm|steering|nozzle)(_angle)?", "an order; the angle that follows is used", _ANGLES),
    _Rule(
        r"(gps_|gnss_)?(speed|velocity)(_(kmh|kn|knots|kts|mps|m_s))?",
        "the positions show the speed over ground",
        _PLACES,
    ),
    _Rule(r"[hvp]dop|n?_?(um_)?sats?(ellites)?(_used)?|fix(_(type|quality))?|rssi", "the state of the receiver"),
    _Rule(r"g_?f[xyz]|(lin(ear)?_)?acc(el)?(eration)?_?[xyz]", "no model takes accelerations"),
    _Rule(r"(imu_)?(gyro?_?x|roll_?(rate|speed)|w_?x)(_rate)?", "the roll angle shows it", _ROLL),
    _Rule(r"(imu_)?(gyro?_?y|pitch_?(rate|speed)|w_?y)(_rate)?", "no model in the plane takes it"),
    _Rule(r"((prop(eller)?|shaft|(main_)?engine)_)?(power|torque)(_kw|_knm)?", "no model takes power or torque"),
)


def columns_not_needed(names: Sequence[str], used: Set[str]) -> dict[str, str]:
    """Return those of the columns that are known and not needed, with the reason; the others are left to be named.

    Args:
        names: of columns that stand for no channel, as the trial file addresses them.
        used: channels of the same log that are used.
    """
    reasons = {name: _reason(name, used) for name in names}
    return {name: reason for name, reason in reasons.items() if reason}


def not_needed_text(reasons: Mapping[str, str], most: int | None = None) -> str:
    """Return the columns with why they are not needed, those of one reason together, those of motions first.

    most: reasons that are given; None: all.
    """
    given = [word.reason for word in (*_UNNEEDED_WORDS, *_UNNEEDED_MESSAGES) if word.reason in reasons.values()]
    by_reason = {why: [name for name in reasons if reasons[name] == why] for why in given}
    parts = [f"{enumeration(names, _NAMES_SHOWN)} ({why})" for why, names in by_reason.items()][:most]
    rest = sum(len(names) for names in list(by_reason.values())[len(parts) :])
    return "; ".join([*parts, f"{rest} more, in the file"] if rest else parts)


def _reason(name: str, used: Set[str]) -> str:
    field = plain_name(_UNIT.sub("", name).rpartition("/")[2])
    matched = [message for message in _UNNEEDED_MESSAGES if re.fullmatch(message.pattern, name.lower())]
    matched += [word for word in _UNNEEDED_WORDS if re.fullmatch(word.pattern, in_english(field))]
    return next((one.reason for one in matched if not one.beside or one.beside & used), "")
