"""The paper's tables with ours beside them."""

import math

import numpy as np

from seatrial.core.results import Table
from seatrial.physics.models import HEAVE_PITCH_COEFFICIENTS as COEFFICIENTS
from seatrial_studies.output_error_fit import OutputErrorResults
from seatrial_studies.pitch_control import pitch_controller_cost_table
from seatrial_studies.published_ship import B53_NOTE, HEADINGS, SHIP, SIGNIFICANT_HEIGHT, SPEED
from seatrial_studies.qi2025.ablation import ABLATION_SETTINGS, Ablation, HerdVariant
from seatrial_studies.qi2025.audit import WildHorseAudit
from seatrial_studies.qi2025.centre_bias import RUNS, CentreBias
from seatrial_studies.qi2025.declarations import FREQUENCY_TITLE, declaration_tables
from seatrial_studies.qi2025.evidence import WildHorseEvidence, count_below_printed, simulated_steps
from seatrial_studies.qi2025.hold_bias import HoldBias
from seatrial_studies.qi2025.published import (
    PRINTED_SECONDS,
    PRINTED_SHIP,
    SearchAlgorithm,
    misprinted_errors,
    printed_error,
    printed_estimate,
    printed_mean_errors,
    true_values,
)
from seatrial_studies.qi2025.reproduction import SearchSetting, WildHorseReproduction
from seatrial_studies.qi2025.ten_runs import BOOTSTRAP_TENS, FAMILY_PROBABILITY
from seatrial_studies.swarm_search import STEP

PAPER_SETTING = SearchSetting.PAPER.value
_RANDOM_GUESS_NOTE = "Means over the coefficients. A guess at random in a box of ±10 % about the truth has 5 %."


def tables(evidence: WildHorseEvidence) -> tuple[Table, ...]:
    """Return all tables in the order of the page."""
    made, own = evidence.reproduction, evidence.output_error
    values = (table for h in HEADINGS for table in (_values(made, h), _errors(made, own[h], h)))
    return (
        *values,
        _below_printed(own),
        *_settings(made),
        _ten_run_means(made),
        _saturation(evidence),
        *_ablations(evidence.ablation),
        _centre_bias(evidence.centre_bias),
        _times(made, own),
        _work(made, own),
        _misprints(),
        _hold_bias(evidence.hold_bias),
        _ship(),
        *declaration_tables(made),
        _frequencies(evidence.audit),
        pitch_controller_cost_table(evidence.controllers),
    )


def _ship() -> Table:
    """Return table 1 of the paper, and what the searches take from it."""
    used = {**SHIP.particulars, "h13": SIGNIFICANT_HEIGHT, "v": SPEED}
    rows = tuple(
        (name, symbol, unit, printed, used.get(key) if key else None, remark)
        for name, symbol, unit, printed, key, remark in PRINTED_SHIP
    )
    header = ("Quantity", "symbol", "unit", "printed", "here, SI", "remark")
    return Table("Table 1: the ship", header, rows, digits=4)


def _values(reproduction: WildHorseReproduction, heading: int) -> Table:
    header, columns = ["", "theory"], [true_values(heading)]
    for a in SearchAlgorithm:
        header += [f"{a} printed", f"{a} here"]
        columns += [
            printed_estimate(heading, a),
            np.abs(reproduction.searches[SearchSetting.PAPER, heading, a].points.mean(axis=0)),
        ]
    rows = tuple((name, *(float(c[k]) for c in columns)) for k, name in enumerate(COEFFICIENTS))
    note = (
        f"Table {2 + HEADINGS.index(heading)} of the paper, SI units. Here: mean of "
        f"{reproduction.run_count} runs, {PAPER_SETTING}. {B53_NOTE}"
    )
    return Table(f"Coefficients at {heading}°", tuple(header), rows, note, digits=4)


def _errors(reproduction: WildHorseReproduction, output_error: OutputErrorResults, heading: int) -> Table:
    header, columns = [""], []
    for a in SearchAlgorithm:
        found = reproduction.searches[SearchSetting.PAPER, heading, a]
        header += [f"{a} printed", "of mean", "single"]
        columns += [printed_error(heading, a), 100.0 * found.error_of_mean, 100.0 * found.mean_error]
    header += ["ours", "ours, noise"]
    columns += [
        100.0 * np.abs(output_error.noise_free_errors).mean(axis=0),
        100.0 * np.abs(output_error.noisy_errors).mean(axis=0),
    ]
    rows = tuple((name, *(float(c[k]) for c in columns)) for k, name in enumerate(COEFFICIENTS))
    mean = ("mean", *(float(np.mean(c)) for c in columns))
    note = (
        "Printed errors are those of the mean of ten runs, as 'of mean' here; 'single': mean error of single runs. "
        "Ours: single fits, without noise and with 1 cm / 0.02°."
    )
    return Table(f"Errors at {heading}°, %", tuple(header), (*rows, mean), note, digits=4)


def _settings(reproduction: WildHorseReproduction) -> list[Table]:
    """One table a setting: what box, fitness and unit decide."""
    tables_ = []
    for setting in reproduction.settings:
        rows = []
        for heading in HEADINGS:
            found = [reproduction.searches[setting, heading, a] for a in SearchAlgorithm]
            cells = [100.0 * float(np.mean(v)) for f in found for v in (f.error_of_mean, f.mean_error)]
            rows.append((f"{heading}°", *cells))
        header = ("Heading", *(f"{a}, {what}" for a in SearchAlgorithm for what in ("of mean", "single")))
        tables_.append(
            Table(f"Errors in %: {setting.value}", header, tuple(rows), _RANDOM_GUESS_NOTE if not tables_ else "")
        )
    return tables_


def _times(reproduction: WildHorseReproduction, output_error: dict[int, OutputErrorResults]) -> Table:
    rows = []
    for h in HEADINGS:
        here = [reproduction.searches[SearchSetting.PAPER, h, a].seconds for a in SearchAlgorithm]
        rows.append((f"{h}°", *PRINTED_SECONDS[h].values(), *here, output_error[h].seconds))
    header = (
        "Heading",
        *(f"{a} printed, s" for a in SearchAlgorithm),
        *(f"{a} here, s" for a in SearchAlgorithm),
        "ours, s",
    )
    note = (
        "Table 5: 200 iterations of 40. Here all three judge their candidates by one simulator; median over the "
        "runs. Times vary by machine and decide nothing."
    )
    return Table("Time of a run", header, tuple(rows), note)


def _work(reproduction: WildHorseReproduction, output_error: dict[int, OutputErrorResults]) -> Table:
    searches = {a: reproduction.searches[SearchSetting.PAPER, HEADINGS[0], a] for a in SearchAlgorithm}
    rows = [(str(a), int(f.evaluations[0]), "one sample, one step", int(f.evaluations[0])) for a, f in searches.items()]
    most = max(o.evaluations for o in output_error.values())
    steps = simulated_steps(most, has_slopes=True)
    note = f"In the chosen setting, {PAPER_SETTING}. Ours: the most at any heading, each slope counted as "
    note += "one simulation. A search by the whole record would take 400 steps for each candidate."
    rows.append(("ours", most, "the whole record, with its slopes", steps))
    header = ("", "candidates", "each by", "simulated steps")
    return Table("Candidates judged in a run", header, tuple(rows), note, digits=6)


def _frequencies(audited: WildHorseAudit) -> Table:
    rows = tuple((f"{h}°", audited.implied_frequencies[h], *audited.encounter_ranges[h]) for h in HEADINGS)
    header = ("Heading", "of the coefficients, rad/s", "least of the waves, rad/s", "largest of the waves, rad/s")
    nyquist = math.pi / STEP
    beyond = " and ".join([f"{r[1]:.2f} at {h}°" for h, r in audited.encounter_ranges.items() if r[1] > nyquist])
    note = (
        "Added mass and damping depend on the frequency of encounter; a set of constants holds at one, that of the "
        "tables by strip theory at a53 − a35 = 2 U b33 / ω². Samples every 0.5 s show no more than "
        f"{nyquist:.2f} rad/s; the waves reach {beyond}, and what lies beyond is aliased. At 90° the waves are met at "
        "their own frequencies, and 30 equal intervals repeat "
        f"the sea after {audited.repetition:.0f} s, within a record of 200 s."
    )
    return Table(FREQUENCY_TITLE, header, rows, note)


def _misprints() -> Table:
    rows = tuple((f"{h}°", str(a), name, said, is_so) for h, a, name, said, is_so in misprinted_errors())
    return Table("Printed errors that do not follow from the printed values",
                 ("Heading", "Algorithm", "Coefficient", "printed %", "recomputed %"), rows)  # fmt: skip


def _hold_bias(bias: dict[int, HoldBias]) -> Table:
    rows = tuple(
        (f"{h}°", *(100.0 * float(f(np.abs(e))) for e in (b.held, b.sampled, b.fine) for f in (np.mean, np.max)))
        for h, b in bias.items()
    )
    taken = ("held", "every 0.5 s", "every 0.1 s")
    header = ("Heading", *(f"{name}, {what}" for name in taken for what in ("mean", "largest")))
    note = (
        "Errors of our fit; data from continuous waves without noise, motions every 0.5 s. Force held as in eq. (8), "
        "or continuous and known every 0.5 s or 0.1 s."
    )
    return Table("What holding the wave force costs, %", header, rows, note)


def _centre_bias(centre: CentreBias) -> Table:
    rows = tuple(
        (str(a), 100.0 * centre.truth_at_centre[a], 100.0 * centre.truth_off_centre[a]) for a in SearchAlgorithm
    )
    note = (
        "Unknowns as x in [-1, 1], ±10 % about the truth, one sample an iteration, pitch in rad; "
        f"{RUNS} runs at three headings."
    )
    header = ("", "truth at x = 0: mean error %", "truth at x = ±0.5: mean error %")
    return Table("Drawn to the middle of the box", header, rows, note)


def _ablations(ablated: Ablation) -> list[Table]:
    """One table a setting: single runs of IWHO, and with parts left out."""
    count = len(ablated.errors[ABLATION_SETTINGS[0], None, HEADINGS[0]])
    tables_ = []
    for setting in ABLATION_SETTINGS:
        rows = []
        for variant in (None, *HerdVariant):
            share = 100.0 * ablated.share_at_centre(setting, variant)
            rows.append((variant or "IWHO complete", *ablated.mean_errors(setting, variant), share))
        header = ("IWHO", *(f"{h}°: mean error %" for h in HEADINGS), "values exactly the truth, %")
        note = (
            f"Mean errors of single runs; {count} runs at each heading of each variant. The truth is the middle of the "
            "box of ±10 %: foals clipped at opposite ends have their mean there (eq. 18)."
        )
        tables_.append(Table(f"Parts of IWHO left out: {setting.value}", header, tuple(rows), note))
    return tables_


def _ten_run_means(reproduction: WildHorseReproduction) -> Table:
    rows = []
    for (h, runs), printed in zip(reproduction.ten_runs.items(), printed_mean_errors(), strict=True):
        tens = 100.0 * runs.tens
        likely = 100.0 * runs.probability_below(0.01 * printed)
        limit = runs.limit_on_median(printed, len(HEADINGS))
        rows.append((f"{h}°", printed, *map(float, (tens[0], np.median(tens), tens.min(), tens.max())), likely, limit))
    count = len(next(iter(reproduction.ten_runs.values())).tens)
    rarity = 100.0 * FAMILY_PROBABILITY / len(HEADINGS)
    header = (
        "Heading",
        "printed %",
        "first ten %",
        "median %",
        "least %",
        "largest %",
        "drawn tens below the print, %",
        "limit on the median %",
    )
    note = (
        f"IWHO's error of the mean of ten, {PAPER_SETTING}: the ten runs made {count} times in other seas. Last "
        f"columns: {BOOTSTRAP_TENS} tens are drawn from all of these runs; limit: the printed error times their "
        f"median over their quantile of {rarity:.1f} %. A check fails above it, which is where fewer than {rarity:.1f} "
        "% of the drawn tens are as small as the print. Were the paper's runs of this search, one of the three checks "
        f"would fail by chance with a probability of at most {100.0 * FAMILY_PROBABILITY:.0f} %, three times that."
    )
    return Table("What ten runs are worth", header, tuple(rows), note)


def _saturation(evidence: WildHorseEvidence) -> Table:
    hit, of = evidence.audit.saturated_values
    rows: list[tuple[str | float | None, ...]] = [("printed", None, hit)]
    for setting in evidence.reproduction.settings:
        if setting not in (SearchSetting.OFF_CENTRE, SearchSetting.WHOLE_OFF_CENTRE):
            share = 100.0 * evidence.share_at_lower_bound(setting, SearchAlgorithm.WHO)
            rows.append((setting.value, share, evidence.saturated_means(setting)))
    header = (
        "WHO, ±10 % about the truth",
        "values of single runs on the lower bound, %",
        f"means beyond -9.3 %, of {of}",
    )
    note = "Single runs at three headings; means of ten at 90 and 135°, where the print has its saturated ones."
    return Table("Saturation at the lower bound", header, tuple(rows), note)


def _below_printed(output_error: dict[int, OutputErrorResults]) -> Table:
    rows = tuple(
        (
            f"{h}°",
            *(
                count_below_printed(e, h)
                for e in (
                    np.mean(np.abs(o.noise_free_errors), axis=0),
                    np.mean(np.abs(o.noisy_errors), axis=0),
                    np.mean(o.noisy_errors, axis=0),
                )
            ),
        )
        for h, o in output_error.items()
    )
    total = ("of 24", *(sum(int(row[k]) for row in rows) for k in (1, 2, 3)))
    header = ("Heading", "noise-free, single fits", "1 cm / 0.02°, single fits", "1 cm / 0.02°, mean of ten")
    note = "Of eight entries a heading, how many of ours are below IWHO's printed error; the print is free of noise."
    return Table("Ours below the printed errors of IWHO", header, (*rows, total), note)
