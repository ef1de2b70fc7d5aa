"""What findings say of times in a run, and what follows where nothing is done."""

import re
from collections.abc import Iterable
from dataclasses import replace

import numpy as np

from seatrial.core.values import Finding, Record, Severity, TrialEdit
from seatrial.core.values.notation import OPPOSITE

# Times in findings: seconds from the start of the run, with the logger's own clock in brackets where it differs.

_MOMENT = re.compile(r"\bt = (-?[\d.e+-]+)(?: to (-?[\d.e+-]+))? s\b")
_DIGITS, _DECIMALS = 12, 3  # of a stamp on its way into the text; of a time in it: a logger's clock is no finer


def moment(*times: float) -> str:
    """Return a time, or the ends of a stretch, of the logger's clock [s] as `on_run_clock` looks for them."""
    return f"t = {' to '.join(f'{float(time):.{_DIGITS}g}' for time in times)} s"


def on_run_clock(finding: Finding, start: float) -> Finding:
    """Return a finding whose times count from `start` [s on the logger's clock], the first stamp of the run."""

    def counted_from_start(match: re.Match[str]) -> str:
        stamps = [float(group) for group in match.groups() if group is not None]
        text = f"t = {_seconds([stamp - start for stamp in stamps])} s"
        return text if start == 0.0 else f"{text} [clock {_seconds(stamps)} s]"

    texts = (_MOMENT.sub(counted_from_start, text) for text in (finding.message, finding.evidence))
    return replace(finding, **dict(zip(("message", "evidence"), texts, strict=True)))


def _seconds(times: list[float]) -> str:
    return " to ".join(f"{round(time, _DECIMALS) + 0.0:.{_DIGITS}g}" for time in times)


# What follows from each kind of finding where nothing is done, most harmful first; its edits in their final form.

REVERSED = '"reversed"'
"""Value of an edit of ``positive`` that stands for the opposite of what is declared."""

CONSEQUENCES: dict[str, str] = {
    "rows-dropped": "the run would be fitted on what the repair left",
    "wrong-frame": "motions of other directions are mixed: no coefficient means anything",
    "mislabelled": "the model is fitted to another quantity",
    "wrong-unit": "the channel is wrong by a factor: the fit diverges or ignores it",
    "wrong-zero": "velocities are turned by a wrong angle: surge shows as sway",
    "wrong-sign": "coefficients get the wrong sign: a controller tuned on them steers the wrong way",
    "contradiction": "damping is fitted to another motion",
    "thruster-side": "thrust coefficients get the wrong sign: a controller tuned on them turns the wrong way",
    "command-range": "thrust is extrapolated far beyond full command",
    "stuck": "the fit follows a sensor that stopped",
    "dead-channel": "the channel says nothing, and would be fitted as if it did",
    "jump": "single positions pull the fit",
    "no-reading": "they would count as measured; they are left empty",
    "outlier": "single samples would pull the fit; they are interpolated",
    "lag": "damping and lever coefficients absorb the delay",
    "closure": "what the channels contradict one another by goes into the coefficients as bias",
    "approach": "overshoots, advance and approach speed are those of a craft that is still settling",
    "resting-level": "waves do not explain it: the run is missed by that much, and stiffness is bent to it",
    "held-roll": "what holds the ship is no part of the model: the decay is fitted with a motion that it is not",
    "dead-thruster": "its coefficients cannot be estimated",
    "no-excitation": "the coefficients of steering cannot be estimated",
    "copied-run": "a run that counts twice makes intervals too narrow",
    "time-base": "rates are wrong where the clock is",
    "time-gap": "fewer samples count",
    "empty-rows": "the run falls into parts with initial states of their own",
    "empty-cells": "an input is taken as straight between its readings; nothing else is compared there",
    "repeated-rows": "repeated rows would count twice; they are dropped",
    "resolution": "steps of the sensor count as noise",
    "integration-step": "time constants come out wrong by up to half a step",
    "stepped-input": "as straight lines between samples the steps would come half a sample early",
    "feedback": "output error would take disturbances that are answered for the ship's response",
}
"""Code -> consequence; findings of one severity come in this order."""


def completed(findings: Iterable[Finding], record: Record) -> list[Finding]:
    """Return findings with consequence, exact edits and times from the start of the run, most harmful first.

    record: as it was read, with the declared directions that edits of ``positive`` reverse.
    """
    codes = list(CONSEQUENCES)
    severities = list(Severity)
    start = float(np.nanmin(record.time))
    with_consequence = [replace(finding, consequence=CONSEQUENCES.get(finding.code, "")) for finding in findings]
    final = [on_run_clock(_with_edits(one, record), start) for one in with_consequence]
    return sorted(
        final,
        key=lambda one: (
            -severities.index(one.severity), codes.index(one.code) if one.code in CONSEQUENCES else len(codes),
        ),
    )  # fmt: skip


def _with_edits(finding: Finding, record: Record) -> Finding:
    if not finding.edits:
        return finding
    edits = tuple(_resolved(edit, record) for edit in finding.edits)
    advice = f"set {'; '.join(map(str, edits))}" if not edits[0].exchanged_with else "; ".join(map(str, edits))
    return replace(finding, edits=edits, advice=f"{advice} in the trial file")


def _resolved(edit: TrialEdit, record: Record) -> TrialEdit:
    """The edit with the opposite of the declared direction; numbers in the sense in which the file counts."""
    symbol = edit.key.split(".")[1]
    if edit.value == REVERSED:
        return replace(edit, value=f'"{OPPOSITE[record.channel(symbol).positive]}"')
    return edit
