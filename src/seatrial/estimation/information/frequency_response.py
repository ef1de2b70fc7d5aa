"""Frequency responses of records and of the model over the same runs, by one estimator."""

from collections.abc import Sequence

import numpy as np

from seatrial.core.equations import Model
from seatrial.core.results.prediction import Prediction
from seatrial.core.results.ship_motions import FrequencyResponse, Mask
from seatrial.core.values import Record
from seatrial.core.values.notation import channel_unit
from seatrial.estimation.information.cross_spectra import CrossSpectra, cross_spectra

SEGMENTS = 8
"""Segments that all samples are cut into, half overlap not counted; chosen, a compromise of resolution and scatter."""
FEWEST_SAMPLES = 32
"""Samples of a segment below which no response is estimated; chosen."""
BANDS = 40
"""Bands of the logarithmic frequency scale over which densities are averaged; chosen."""
EXCITED_SHARE = 1e-3
"""Density of the input over its largest (-30 dB) from which on a frequency counts as excited; chosen."""
_INTEGRALS = {"psi": "r", "phi": "p", "theta": "q"}  # angle -> its rate, which stands for both where it is compared
_TRACK = ("x0", "y0")  # a track is no linear response of a helm


def frequency_responses(
    model: Model, predictions: Sequence[Prediction], compared: Sequence[str]
) -> tuple[FrequencyResponse, ...]:
    """Return the response of each compared channel to each input that moves, over all runs simulated to their end.

    Tracks are left out, and angles whose rate is compared as well. Runs shorter than a segment are left out.
    """
    runs = [p for p in predictions if p.divergence is None]
    outputs = [c for c in compared if c not in _TRACK and _INTEGRALS.get(c) not in compared]
    outputs = [c for c in outputs if any(c in p.measured and c in p.simulated for p in runs)]
    inputs = [n for n in model.input_names if any(n in p.measured and np.ptp(p.measured[n]) > 0.0 for p in runs)]
    if not runs or not outputs:
        return ()
    length = segment_length([len(p.measured) for p in runs])
    if length < FEWEST_SAMPLES:
        return ()
    return tuple(r for name in inputs for output in outputs for r in _response(runs, name, output, length))


def segment_length(rows: Sequence[int]) -> int:
    """Return the samples of a segment: an eighth of all of them, but no more than the median run has; even."""
    return 2 * (min(sum(rows) // SEGMENTS, int(np.median(rows))) // 2)


def _response(runs: Sequence[Prediction], name: str, output: str, length: int) -> list[FrequencyResponse]:
    """The response of one output to one input; none where no segment is measured without gaps or nothing moves."""
    pairs = [p for p in runs if name in p.measured and output in p.measured and output in p.simulated]
    pieces = [(p.measured[name], np.column_stack([p.measured[output], p.simulated[output]])) for p in pairs]
    spectra = cross_spectra(pieces, length, pairs[0].measured.dt) if pairs else None
    if spectra is None:
        return []
    spectra = spectra.banded(BANDS)
    excited = spectra.input >= EXCITED_SHARE * np.max(spectra.input)
    if not np.max(spectra.input) > 0.0:
        return []
    rows = slice(int(np.argmax(excited)), len(excited) - int(np.argmax(excited[::-1])))
    return [_result(spectra, rows, excited, _names(pairs[0].measured, name, output))]


def _names(record: Record, name: str, output: str) -> tuple[str, str, str]:
    units = [record.channel(c).unit if c in record else channel_unit(c) for c in (output, name)]
    return name, output, _ratio(*units)


def _ratio(output: str, name: str) -> str:
    """Unit of an output over an input."""
    if name == "1":
        return output
    return f"{output} / ({name})" if " " in name or "/" in name else f"{output} / {name}"


def _result(spectra: CrossSpectra, rows: slice, excited: Mask, names: tuple[str, str, str]) -> FrequencyResponse:
    response = spectra.response[rows]
    return FrequencyResponse(
        *names, spectra.omega[rows], response[:, 0], response[:, 1], spectra.coherence[rows, 0],
        spectra.radius[rows, 0], spectra.averages[rows], tuple(map(bool, excited[rows])),
    )  # fmt: skip
