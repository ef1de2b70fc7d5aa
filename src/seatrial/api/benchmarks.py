"""Methods against benchmark problems."""

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from seatrial.core.results.campaign import Benchmark
    from seatrial.core.values import ProgressReporter

RUNS = 30
"""Runs of a method on a problem where none are stated."""


def benchmark(
    problems: str | Sequence[str],
    out: str | Path,
    *,
    methods: str | Sequence[str] = (),
    against: Sequence[str] | None = None,
    runs: int = RUNS,
    seed: int = 0,
    as_published: bool = False,
    workers: int | None = None,
    report_progress: "ProgressReporter | None" = None,
) -> "Benchmark":
    """Run methods against benchmark problems and return how good they are.

    A run that is in the folder already is not made again; more runs, problems and methods go on with it.

    Args:
        problems: names, families (``qi2025``) or patterns (``qi2025-*-whole``).
        out: folder of the runs, of the page benchmark.html and of benchmark.json.
        methods: your own: ``FILE.py``, ``FILE.py:Name``, ``module:Name``, or the name of an installed optimiser. A file
            is executed, because you name it.
        against: built-in methods that they are compared with; None: all that suit a problem.
        runs: of each method on each problem.
        seed: first one; run k has seed + k.
        as_published: put the truth where the paper has it, which shows no bias to the middle of the box.
        workers: processes; None: as many as cores. The results are the same to the bit, times apart.
        report_progress: called with one line of text about a hundred times.

    Raises:
        InputError: no such problem or method, a file that is no method, no runs, or a folder of something else.
    """
    from seatrial.campaigns.benchmark_work import benchmark_work
    from seatrial.campaigns.run_campaign import CampaignOptions, run_campaign
    from seatrial.campaigns.store import open_store
    from seatrial.campaigns.summary import benchmark_result
    from seatrial.core.values import InputError
    from seatrial.core.values.files import remove_file, write_atomically
    from seatrial.data.folder.document import document, strict_json
    from seatrial.problems import Placement, built_in_methods, method_named, problems_matching
    from seatrial.reporting.pages import report_page

    if runs < 1:
        raise InputError(f"{runs} runs show nothing; give at least 1")
    folder, seeds = Path(out), range(seed, seed + runs)
    chosen = problems_matching((problems,) if isinstance(problems, str) else tuple(problems))
    entered = [method_named(text) for text in ((methods,) if isinstance(methods, str) else methods)]
    compared = built_in_methods() if against is None else {name: method_named(name) for name in against}
    every = list({m.name: m for m in (*entered, *compared.values())}.values())
    placement = Placement.PUBLISHED if as_published else Placement.SHIFTED
    work = benchmark_work(chosen, every, seeds, placement)
    run_campaign(work, folder, CampaignOptions(workers=workers), report_progress)
    result = benchmark_result(open_store(folder), chosen, every, seeds, placement)
    page = folder / "benchmark.html"
    remove_file(page)  # so that it never stands beside the table of another benchmark
    write_atomically(folder / "benchmark.json", strict_json(document(result)).encode())
    write_atomically(page, report_page(result).encode())
    return result
