"""The ready trial files of the package: one source, ``examples/``, which an installed package carries beside this."""

import os
from pathlib import Path

from seatrial.core.values import InputError
from seatrial.data.trial import Trial, load_trial

_EXAMPLE_FOLDERS = (Path(__file__).with_name("examples"), Path(__file__).parents[2] / "examples")


def packaged_trial(name: str) -> Trial:
    """Return the trial of ``examples/NAME`` on the records in SEATRIAL_DATA.

    Raises:
        InputError: SEATRIAL_DATA is not set or no folder, the file is not there, or the trial's own errors.
    """
    folder = os.environ.get("SEATRIAL_DATA")
    if not folder or not Path(folder).is_dir():
        reason = f"SEATRIAL_DATA names '{folder}', which is no folder" if folder else "SEATRIAL_DATA is not set"
        raise InputError(f"the measured records are not part of the package and {reason}; set it to their folder")
    for place in _EXAMPLE_FOLDERS:
        if (place / name).is_file():
            return load_trial(place / name)
    raise InputError(
        f"the trial file '{name}' is neither in {' nor in '.join(map(str, _EXAMPLE_FOLDERS))}; install again"
    )
