"""What to write for a name that is no channel: the field's other words, else a name that is nearly the same."""

from seatrial.core.values.errors import listed

ALIASES: dict[str, str] = {
    "latitude": "lat", "longitude": "lon", "lng": "lon", "hdt": "psi", "yaw": "psi", "hdm": "psi_magnetic",
    "hdg": "psi (true heading) or psi_magnetic", "heading": "psi (true heading) or psi_magnetic",
    "rot": 'r with unit = "deg/min"', "yaw_rate": "r", "course": "cog", "vtw": "stw",
    "speed": "sog (over ground) or stw (through water)", "rudder": "delta", "rud": "delta", "rsa": "delta",
    "helm": "delta", "roll": "phi", "heel": "phi", "pitch": "theta", "heave": "z", "surge": "u", "sway": "v",
    "x": "x0", "y": "y0", "rpm": 'n with unit = "rpm", or rpm_1, rpm_2 of several propellers', "azimuth": "alpha_1",
    "pwm": "command_1 with zero and span", "throttle": "command_1 with zero and span",
    **dict.fromkeys(("utc", "t", "time", "timestamp"), "time = { column = ... } beside the channels, not among them"),
    "north": 'x0 (position) or u with frame = "earth"', "east": 'y0 (position) or v with frame = "earth"',
}  # fmt: skip
"""Name that people use -> what to write for a column."""
_DERIVED = {
    "lat": "x0", "lon": "y0", "sog": "u", "cog": "v", "stw": "u", "psi_magnetic": "psi",
    **dict.fromkeys(("q_w", "q_x", "q_y", "q_z"), "psi"),
}  # fmt: skip
_TIME = "time"
_FEWEST_LETTERS, _LIKENESS = 3, 0.75  # of a name that may be meant; ours: one letter of four may differ


def channel_hint(name: str, valid_names: list[str]) -> str:
    """Return the end of a sentence on a name that is no channel: what to write, a name nearly the same, or all names.

    valid_names: the channels there are; of a measurement from which channels derive, that channel is named.
    """
    written = _spelled(name, valid_names)
    if written:
        return f"; did you mean '{written}'?"
    meant = ALIASES.get(name.lower(), name.lower())
    symbol = meant.split()[0].strip(",")
    if symbol in (*valid_names, _TIME) and meant != name.lower():
        return f"; write {meant}"
    if _DERIVED.get(symbol) in valid_names:
        return f"; a record has '{_DERIVED[symbol]}', which follows from it"
    return f"; known are {listed(valid_names)}"


def _spelled(name: str, valid_names: list[str]) -> str:
    """The valid name that differs by its capitals or by a letter or two; empty where there is none."""
    import difflib

    same = [
        valid_name
        for valid_name in valid_names
        if valid_name.lower() == name.lower().replace("-", "_").replace(" ", "_")
    ]
    if same:
        return same[0]
    long = [valid_name for valid_name in valid_names if min(len(valid_name), len(name)) >= _FEWEST_LETTERS]
    swapped = [long_name for long_name in long if sorted(long_name) == sorted(name.lower())]
    near = swapped or difflib.get_close_matches(name.lower(), long, n=1, cutoff=_LIKENESS)
    return near[0] if near and name.lower() not in ALIASES else ""
