"""Write the results that `test_earlier_results.py` loads: `python -m tests.data.folder.write_earlier_results`.

They stand for results of this format that users keep, so they are written anew only when the format changes.
"""

import shutil
from collections.abc import Callable
from pathlib import Path

from tests.reporting import fabricated
from tests.reporting.complete_fit import complete_fit
from tests.reporting.fabricated_comparison import fabricated_comparison
from tests.reporting.fabricated_design import fabricated_design
from tests.reporting.fabricated_study import fabricated_study
from tests.reporting.fabricated_tuning import fabricated_fin
from tests.reporting.test_verification import LEGS

from seatrial.core.results import Summarised
from seatrial.data.folder.result_folder import save_result

FOLDER = Path(__file__).with_name("earlier_results")
RESULTS: dict[str, Callable[[], Summarised]] = {
    "fit": lambda: complete_fit(fabricated.fabricated_fit()),
    "design": fabricated_design,
    "tuning": fabricated_fin,
    "study": lambda: fabricated_study(fabricated.fabricated_fit()),
    "comparison": fabricated_comparison,
    "verification": lambda: LEGS,
}


def main() -> None:
    """Write a folder for each kind of result, with a sample in two seconds, so that it stays small."""
    fabricated.STEP = 2.0
    for name, result in RESULTS.items():
        shutil.rmtree(FOLDER / name, ignore_errors=True)
        save_result(result(), FOLDER / name)


if __name__ == "__main__":
    main()
