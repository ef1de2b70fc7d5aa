"""What the paper does not print, and what stands in its place here."""

from seatrial.core.results import Table
from seatrial_studies.qi2025.reproduction import (
    QUICK_RUNS,
    RUNS,
    TEN_RUN_SETTINGS,
    SearchSetting,
    WildHorseReproduction,
)

_ROWS = (
    ("box of the searches", "not printed", "±10 % about the truth, as WHO's clipped values suggest; others beside it"),
    ("ω, c1, c2 of PSO", "not printed", "0.7298, 1.49618, 1.49618 (constriction), clipped to the box"),
    ("state a candidate steps from", "not printed", "the true previous one (generous); the model's own beside it"),
    ("unit of pitch in eq. (28)", "not printed", "rad; degrees beside it"),
    ("remembered fitness", "not printed", "judged again by each new sample; kept beside it (full run)"),
    ("coefficients at 45°", "not printed", "those of 90°"),
    ("forces of the waves", "not printed", "box-shaped hull in closed form, Jensen, Mansour & Olsen 2004"),
    ("phases of the harmonics", "not printed", "random, one sea a run; 30 equal intervals of frequency"),
    ("sign of b53", "positive", "negative, as strip theory has it"),
    ("measurement noise", "V in eq. (7), no number", "none; 1 cm and 0.02° for our fit beside it"),
    ("state at the start", "not printed", "at rest"),
)  # fmt: skip


def assumption_table(reproduction: WildHorseReproduction) -> Table:
    """One row for each; the note says what was left out of a quick run."""
    left = [s.value for s in SearchSetting if s not in reproduction.settings]
    ten = " and ".join(f"'{s.value}'" for s in TEN_RUN_SETTINGS)
    times = f"{QUICK_RUNS} times ({ten}: {RUNS})" if reproduction.is_quick else f"{RUNS} times"
    note = (
        "Unit, memory and state were chosen as the combination whose IWHO comes nearest to the print; the tables of "
        f"settings show the others. Every setting is run {times}."
    )
    if left:
        note += f" Left out of this quick run: {'; '.join(left)}."
    return Table("Assumed", ("what", "print", "here"), _ROWS, note)
