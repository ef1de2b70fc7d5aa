"""Figures of the study: table 1, figures 3 to 7, answers over seeds, roll against fin rate."""

import numpy as np

from seatrial.core.results import Bars, Curve, Figure
from seatrial.physics.loops import Preamplifier
from seatrial_studies.yu2014.energy_tables import fin_rate_ratios
from seatrial_studies.yu2014.evidence import FinGainEvidence
from seatrial_studies.yu2014.published import GAIN_NAMES, TABLE_1
from seatrial_studies.yu2014.published_loop import PREAMPLIFIER_LABELS, FinObjective
from seatrial_studies.yu2014.searches import BOX


def figures(evidence: FinGainEvidence) -> tuple[Figure | Bars, ...]:
    """Return all figures in the order of the page."""
    return (
        fin_rate_ratios(evidence),
        _reductions(evidence),
        *_histories(evidence),
        *(_search_results(evidence, r) for r in Preamplifier),
        _sensitivity_peaks(evidence),
        _roll_against_rate(evidence),
    )


def _reductions(evidence: FinGainEvidence) -> Bars:
    series = {"paper, GA": tuple(row.genetic.reduction for row in TABLE_1)}
    for reading in Preamplifier:
        series[f"{PREAMPLIFIER_LABELS[reading]}, K_q fitted"] = tuple(
            m.reduction for m in evidence.table_1_responses[reading]
        )
    return Bars(
        "Table 1: roll reduction with the GA's gains",
        tuple(row.name for row in TABLE_1),
        series,
        "reduction [%]",
        "Long-crested sea, K_q fitted to 18 / 90 alone; K_alpha grows with the square of the speed.",
    )


def _histories(evidence: FinGainEvidence) -> list[Figure]:
    h, fit = evidence.histories, evidence.best_fit
    note = (
        f"One realisation, 18 kn, 90°; {PREAMPLIFIER_LABELS[fit.preamplifier]}, short-crested, K_q and the "
        "level fitted to table 1, "
        "the traditional PID's gains fitted to its column."
    )
    drawn = (
        ("Figure 3: roll without fins", "roll [°]", h.uncontrolled),
        ("Figure 4: roll under the traditional PID (fitted)", "roll [°]", h.pid[0]),
        ("Figure 5: roll under the GA's gains", "roll [°]", h.genetic[0]),
        ("Figure 6: fin rate under the traditional PID (fitted)", "fin rate [°/s]", h.pid[1]),
        ("Figure 7: fin rate under the GA's gains", "fin rate [°/s]", h.genetic[1]),
    )
    return [
        Figure(title, "time [s]", label, (Curve(f"rms {np.std(y):.2f}", h.time, y),), note) for title, label, y in drawn
    ]


def _search_results(evidence: FinGainEvidence, preamplifier: Preamplifier) -> Bars:
    found = evidence.searches_with(preamplifier)
    shares = 100.0 * (found.gains - BOX.lower) / BOX.width
    return Bars(
        f"Answers of the published search by seed, preamplifier {PREAMPLIFIER_LABELS[preamplifier]}",
        tuple(str(k + 1) for k in range(len(shares))),
        {name: tuple(float(v) for v in shares[:, i]) for i, name in enumerate(GAIN_NAMES)},
        "share of the searched range [%]",
        "The paper's answer: 11.1, 0.9 and 32.7 %.",
    )


def _sensitivity_peaks(evidence: FinGainEvidence) -> Bars:
    series = {}
    for reading in Preamplifier:
        for fins in FinObjective:
            series[f"{PREAMPLIFIER_LABELS[reading]}, {fins.value}"] = tuple(
                float(v) for v in evidence.searches_with(reading, fins).Ms
            )
    count = len(evidence.searches[0].Ms)
    return Bars(
        "Sensitivity peak of these answers",
        tuple(str(k + 1) for k in range(count)),
        series,
        "Ms",
        "A stabiliser should not exceed 2.",
        is_logarithmic=True,
    )


def _roll_against_rate(evidence: FinGainEvidence) -> Figure:
    made = evidence.five_gain_design
    names = {3: "three gains", 5: "five gains"}
    curves = [Curve(names[count], made.rate_ratios, roll) for count, roll in made.roll_ratios.items()]
    paper = (np.array([0.97, 1.03, 1.0, 1.0, 1.0]), np.array([1.0, 1.0, 1.0, 0.97, 1.03]))
    return Figure(
        "Roll against fin rate, washout, Ms at most 2",
        "fin-rate variance allowed / paper's",
        "roll variance / paper's",
        (*curves, Curve("paper's gains", *paper)),
        "The worse of long- and short-crested ITTC seas of 3.3 m. KP, KI, KD in the box of the paper.",
    )
