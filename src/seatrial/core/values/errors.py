"""Errors that a user can meet: bad input, in one sentence."""


class InputError(ValueError):
    """States what is wrong, where, and what to do; the command line prints it and exits with code 2."""


class DivergedError(InputError):
    """States where and when a simulation left all bounds."""


def spelling_hint(name: str, valid_names: list[str]) -> str:
    """Return the end of a sentence that names the valid name most like `name`, or all of them where none is alike."""
    import difflib

    close = difflib.get_close_matches(name, valid_names, n=1, cutoff=0.5)
    return f"; did you mean '{close[0]}'?" if close else f"; known are {', '.join(valid_names)}"
