"""The one exception a user meets: bad input, said in one sentence."""


class InputError(ValueError):
    """What is wrong, where, and what to do; the command line prints it and exits with code 2."""


class DivergedError(InputError):
    """A simulation that leaves all bounds."""


def spelling_hint(name: str, valid_names: list[str]) -> str:
    """A hint naming the known word most like `name`, or an empty string."""
    import difflib

    close = difflib.get_close_matches(name, valid_names, n=1, cutoff=0.5)
    return f"; did you mean '{close[0]}'?" if close else f"; known are {', '.join(valid_names)}"
