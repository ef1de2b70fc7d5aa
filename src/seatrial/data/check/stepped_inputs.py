"""Inputs that step from sample to sample, and records of a simulation that stepped with its own sample interval."""

from seatrial.core.text.words import enumeration
from seatrial.core.values import Finding, Record, Severity
from seatrial.core.values.between import travel
from seatrial.data.check.channels import yaw_rate_lag
from seatrial.data.check.repair import INPUT_CHANNELS

_HALF = 0.5  # samples by which an explicit step moves the heading against the yaw rate (Euler's method)
_CERTAIN = 4.0  # standard errors by which that lag differs from none; chosen, as real clocks are seldom so even
_SLACK = 0.05  # samples by which such a lag may differ besides its error; chosen
_LARGEST_ERROR = 0.1  # samples, standard error of a lag above which nothing is said; chosen


def stepped_input_findings(record: Record) -> tuple[Finding, ...]:
    """Return a note on the inputs of a clean record that are taken as held because they step within single samples."""
    travels = {
        s: travel(record.channel(s).values) for s in INPUT_CHANNELS if s in record and not _is_declared(record, s)
    }
    stepped = [s for s, one in travels.items() if one.is_stepped]
    if not stepped:
        return ()
    names, verb = enumeration(stepped, len(stepped)), "changes" if len(stepped) == 1 else "change"
    text = f"record '{record.name}': {names} {verb} within single samples, as orders do"
    share = min(travels[s].steps / travels[s].total for s in stepped)
    evidence = f"{100.0 * share:.0f} % of their travel; held from sample to sample, steps known to one sample"
    advice = 'declare between = "straight" for a sensor that moved evenly between samples'
    return (Finding(Severity.INFO, "stepped-input", text, evidence, advice),)


def _is_declared(record: Record, symbol: str) -> bool:
    channel = record.channel(symbol)
    return bool(channel.between) or channel.is_command


def integration_step_findings(record: Record) -> tuple[Finding, ...]:
    """Return a warning where heading and yaw rate of a clean record are half a sample apart, as Euler's method leaves.

    With psi(k+1) = psi(k) + dt r(k) the heading lies half a step behind the rate (Hairer, Norsett & Wanner 1993,
    section I.7), and a time constant T decays as one of -dt / ln(1 - dt / T): shorter by half a step.
    """
    lag, error = yaw_rate_lag(record) or (0.0, 0.0)
    distance = abs(abs(lag) - _HALF * record.dt)
    if abs(lag) < _CERTAIN * error or distance > 2.0 * error + _SLACK * record.dt or error > _LARGEST_ERROR * record.dt:
        return ()
    if not any(travel(record[s]).is_stepped for s in INPUT_CHANNELS if s in record):
        return ()  # a loop that integrates by whole samples orders by whole samples, too
    text = f"record '{record.name}': heading and yaw rate are half a sample apart, as in a simulation by Euler's method"
    evidence = f"{lag / record.dt:.2f} samples, standard error {error / record.dt:.2g}"
    advice = f"simulate in steps far below {record.dt:g} s and keep every so many; of a log, correct the clocks"
    return (Finding(Severity.WARNING, "integration-step", text, evidence, advice),)
