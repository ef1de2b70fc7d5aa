"""The pictures of the guides: each is a function in docs/drawn, drawn from the examples by the package itself.

`python docs/make_pictures.py [NAME ...]` writes ``docs/pictures/NAME.svg``, by default all. Pictures of recorded ships
are made where SEATRIAL_DATA is set, those of exported programs where a C compiler is; else the committed ones stay.
"""

import os
import shutil
import sys
from collections.abc import Callable
from pathlib import Path

import matplotlib.pyplot as plt
from drawn import choices, contributions, exports, results
from matplotlib.figure import Figure

DOCS = Path(__file__).parent
PICTURES = DOCS / "pictures"
PICTURE_FUNCTIONS: tuple[Callable[[], Figure], ...] = (
    results.held_out, results.bad_fit, results.criteria, results.log_parts, results.front, results.thrust_curve,
    results.roll_decay, results.heave_pitch, results.designed, results.coverage, results.loop_blocks,
    choices.axes_and_signs, choices.manoeuvres, choices.regressions, choices.searches, choices.entered, choices.gusts,
    choices.followed, choices.own_model, choices.both_sides, choices.sides_and_depth,
    choices.heel, choices.proposed,
    exports.export_casadi, exports.export_matlab, exports.export_gazebo, exports.export_ardupilot,
    contributions.contributed_model, contributions.contributed_reader, contributions.contributed_check,
    contributions.contributed_estimator, contributions.contributed_optimiser, contributions.contributed_figure,
    contributions.contributed_study,
)  # fmt: skip
COMPILED: tuple[Callable[[], Figure], ...] = (exports.export_c99, exports.export_fmu)
RECORDED: tuple[Callable[[], Figure], ...] = (
    results.kvlcc2_zigzag, results.kvlcc2_series, results.kvlcc2_coefficients, results.kvlcc2_turn,
    results.section_waves,
)  # fmt: skip


def main(names: list[str]) -> None:
    """Draw the named pictures, or all that can be made here."""
    functions = PICTURE_FUNCTIONS + (RECORDED if os.environ.get("SEATRIAL_DATA") else ())
    functions += COMPILED if shutil.which("cc") else ()
    PICTURES.mkdir(exist_ok=True)
    for function in functions:
        if not names or function.__name__ in names:
            path = PICTURES / f"{function.__name__}.svg"
            function().savefig(path, metadata={"Date": None})
            plt.close("all")
            print(path.relative_to(DOCS.parent))


if __name__ == "__main__":
    main(sys.argv[1:])
