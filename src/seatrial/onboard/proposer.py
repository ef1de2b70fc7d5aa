"""Gains proposed while a stream is followed, and whether a stream has the channels that its model needs."""

import math
from collections import deque
from pathlib import Path
from typing import Protocol

import numpy as np

from seatrial.control.craft_proposals import CraftNow, propose_for_craft
from seatrial.control.loopfile.load import parse_loop, tuning_task
from seatrial.control.proposals import (
    RATE,
    SHORTEST_PERIODS,
    Stretch,
    look,
    no_proposal,
    refuse_other_craft,
)
from seatrial.control.schedule import gain_schedule
from seatrial.control.task import Seaway, TuningTask
from seatrial.control.verification.stabiliser import natural_period
from seatrial.core.equations.model import ZERO_BY_DEFAULT
from seatrial.core.results.online import Proposal, Sample, Snapshot
from seatrial.core.values import Array, Channel, InputError, Record
from seatrial.core.values.files import write_atomically
from seatrial.data.check.conventions import canonical_record
from seatrial.data.folder.gains_file import proposal_toml, read_gains, read_schedule
from seatrial.data.folder.model_file import ModelFile, read_model_file
from seatrial.data.read.assemble import record_from_values
from seatrial.data.trial import Role, Trial
from seatrial.data.trial.runs import expand_variables, require_stream
from seatrial.data.trial.settings import ProposalSettings
from seatrial.estimation.identify.online import OnlineEstimator
from seatrial.physics.simulate.states import hidden_states, unobserved_states

# Whether a stream has the channels its model needs, checked before anything is started.

_WAVE_FORCES = ("F3", "M5")
# samples of the record that stands for the stream: enough for every check of a record
_REST_SAMPLES = 32


def check_required_channels(trial: Trial) -> None:
    """Refuse a trial whose [follow] lacks channels that the model needs, all of them named.

    Raises:
        InputError: the file is one of the trial's records already; inputs and states that are neither recorded nor
            implied; no channel that the model can be compared with; conventions that cannot be converted.
    """
    stream, model = require_stream(trial), trial.model
    where = f"{trial.path}: " if trial.path else ""
    _check_not_a_record(trial, where)
    record = rest_record(trial)
    inputs = [i.name for i in model.inputs if i.name not in record and i.name not in ZERO_BY_DEFAULT]
    if stream.waves is not None:
        inputs += [] if "zeta" in record or set(_WAVE_FORCES) <= set(record.channels) else ["zeta (or F3 and M5)"]
    hidden = hidden_states(model, [record])
    states = [s for s in unobserved_states(model, record) if s not in hidden]
    if missing := [*inputs, *states]:
        raise InputError(
            f"{where}[follow] lacks channels that model '{model.name}' needs: {', '.join(missing)}; add them to "
            "[follow.channels]"
        )
    if not any(name in record for name in model.observables):
        raise InputError(
            f"{where}[follow] has no channel that model '{model.name}' can be compared with; add one of "
            f"{', '.join(model.observables)} to [follow.channels]"
        )


def _check_not_a_record(trial: Trial, prefix: str) -> None:
    file = require_stream(trial).file
    for run in trial.runs:
        if file is None or run.role is Role.LEAVE_OUT:
            continue
        if file.resolve() in [source.path.resolve() for source in run.files]:
            raise InputError(
                f"{prefix}{file.name} is named under both [[records]] and [follow]; leave it out of the records"
            )


def rest_record(trial: Trial) -> Record:
    """Return a record of the stream's channels, all zero, in canonical conventions."""
    stream = require_stream(trial)
    time = np.arange(_REST_SAMPLES) / stream.rate
    rest = record_from_values("stream", stream.layout, time, np.zeros((_REST_SAMPLES, len(stream.layout.columns))))
    record = canonical_record(rest, trial.reference_point)
    if stream.waves is None or "u" in record:
        return record
    return record.with_channel("u", Channel.from_notation("u", np.full(_REST_SAMPLES, stream.waves.U)))


# Gains proposed while a stream is followed: the latest stretch at one speed and heading, looked at now and then.

_SLOWEST_RATE = 6.0  # samples a natural period, below which the motion is not resolved; chosen
_LONGEST_GAP = 0.25  # natural periods without a sample, above which a stretch has a gap; chosen
_STEADY_SPEED = 0.1  # of the mean: rms of the speed up to which it is one speed; chosen
_STEADY_HEADING = math.radians(10.0)  # rms of the heading up to which it is one heading: waves yaw a craft less; chosen


class GainProposer(Protocol):
    """Takes samples in and holds the newest proposal; it has no thread and no clock of its own.

    Attributes:
        proposal: the newest; without gains before the first look.
        write_error: why the newest could not be written, in words; empty if it was.
    """

    proposal: Proposal
    write_error: str

    def start_run(self) -> None:
        """Begin a run with the next sample."""
        ...

    def add(self, sample: Sample) -> None:
        """Take in a sample, and look where it is time to."""
        ...


class Estimating(Protocol):
    """What is estimated by now: the coefficients of a snapshot, and their covariance (k, k)."""

    @property
    def covariance(self) -> Array: ...

    @property
    def snapshot(self) -> Snapshot: ...


def gain_proposer(
    trial: Trial, settings: ProposalSettings, estimator: object, file: Path | None = None, seed: int = 0
) -> GainProposer:
    """Return what proposes gains of a loop: by the coefficients of the moment where its plant is the model followed.

    Raises:
        InputError: loop file or gains cannot be read, or are of another craft than the stream's.
    """
    plant = parse_loop(settings.loop).plant
    if plant.model is None or trial.model.is_roll or not trial.model.parameters.free_names:
        return SeaGainProposer(trial, settings, file, seed)
    base = read_model_file(settings.loop.resolve().parent / expand_variables(plant.model))
    if base.model.name != trial.model.name:
        return SeaGainProposer(trial, settings, file, seed)
    if not isinstance(estimator, OnlineEstimator):
        raise InputError(
            f"method '{trial.estimate.method}' gives no intervals, on which gains could rest; leave out [proposal], or "
            "the method"
        )
    return CraftGainProposer(base, settings, estimator, file, seed)


class CraftGainProposer:
    """Proposes gains for the craft as its coefficients are by now, every so often; of any loop on an identified model.

    Attributes:
        proposal: the newest; without gains before the first look.
        write_error: why the newest could not be written, in words; empty if it was.
    """

    def __init__(
        self,
        base: ModelFile,
        settings: ProposalSettings,
        estimator: Estimating,
        file: Path | None = None,
        seed: int = 0,
    ) -> None:
        """Take the model file of the loop, and read loop file and gains; `file`: where each proposal is written.

        Raises:
            InputError: they cannot be read, or the gains are of another loop.
        """
        self._base, self._settings, self._estimator, self._seed = base, settings, estimator, seed
        self._output = _ProposalFile(file)
        task = tuning_task(settings.loop, model_file=base)
        gains = read_gains(settings.gains)
        names = task.loop.gains.names
        if set(gains) != set(names):
            raise InputError(
                f"'{settings.gains}' has gains {', '.join(gains)}, the loop has {', '.join(names)}: they are of two "
                "loops; run 'seatrial tune' on this loop file again"
            )
        self._current = np.array([gains[name] for name in names])
        self._name, self._names, self._looked_at = task.name, names, -math.inf
        self.proposal = no_proposal(task, math.nan, math.nan, "no coefficients have been looked at yet")
        self.write_error = self._output.write(self.proposal)

    def start_run(self) -> None:
        """Begin a run with the next sample: the coefficients stay those of all runs."""
        self._looked_at = -math.inf

    def add(self, sample: Sample) -> None:
        """Take in a sample, and look at the coefficients where it is time to."""
        if math.isinf(self._looked_at):
            self._looked_at = sample.time
        if sample.time - self._looked_at < self._settings.every_s:
            return
        self._looked_at = sample.time
        self.proposal = self._proposed(sample.time)
        if self.proposal.has_gains:
            self._current = np.array([self.proposal.gains[name] for name in self._names])
        self.write_error = self._output.write(self.proposal)

    def _proposed(self, time: float) -> Proposal:
        snapshot = self._estimator.snapshot
        since = 0.0 if snapshot.change is None else snapshot.change.reported_at
        craft = CraftNow(snapshot.names, snapshot.value, self._estimator.covariance, time, since)
        try:
            return propose_for_craft(self._task, self._base, craft, self._current, self._seed)
        except (InputError, np.linalg.LinAlgError, ArithmeticError) as error:
            return Proposal(self._name, since, time, {}, (str(error),))

    def _task(self, file: ModelFile) -> TuningTask:
        return tuning_task(self._settings.loop, model_file=file)


class _ProposalFile:
    """Where each proposal is written, if anywhere."""

    def __init__(self, path: Path | None) -> None:
        self._path = path

    def write(self, proposal: Proposal) -> str:
        """Write it, and return why it could not be written; empty if it was."""
        if self._path is None:
            return ""
        try:
            write_atomically(self._path, proposal_toml(proposal).encode())
        except InputError as error:
            return str(error)
        return ""


class SeaGainProposer:
    """Proposes the gains of a schedule for the sea and the craft that the latest stretch of roll shows.

    Attributes:
        proposal: the newest; without gains before the first look.
        write_error: why the newest could not be written, in words; empty if it was.
    """

    def __init__(self, trial: Trial, settings: ProposalSettings, file: Path | None = None, seed: int = 0) -> None:
        """Read loop file and schedule; `file`: where each proposal is written.

        Raises:
            InputError: they cannot be read, are of two crafts, or the stream lacks the loop's channels.
        """
        self._trial, self._settings, self._seed = trial, settings, seed
        self._output = _ProposalFile(file)
        self._task = tuning_task(settings.loop)
        points = read_schedule(settings.gains)
        refuse_other_craft(self._task, points, f"'{settings.gains}'")
        self._schedule = gain_schedule(points, self._task.loop.gains.names)
        _refuse_unsuitable(self._task, settings, require_stream(trial).rate)
        _refuse_missing_channels(self._task, rest_record(trial))
        self._current: Array | None = None
        self.start_run()
        self.proposal = no_proposal(self._task, math.nan, math.nan, "no stretch of the stream has been looked at yet")
        self.write_error = self._output.write(self.proposal)

    def start_run(self) -> None:
        """Begin a run with the next sample: a stretch does not reach over a break."""
        self._samples: deque[Sample] = deque()
        self._looked_at = -math.inf

    def add(self, sample: Sample) -> None:
        """Take in a sample, and look at the latest stretch where it is time to."""
        self._samples.append(sample)
        while self._samples[0].time < sample.time - self._settings.stretch_s:
            self._samples.popleft()
        is_due = sample.time - max(self._looked_at, self._samples[0].time) >= self._settings.every_s
        if is_due:
            self._looked_at = sample.time
            self._look()

    def _look(self) -> None:
        try:
            self.proposal = look(self._task, self._schedule, self._stretch(), self._current, self._seed)
        except (InputError, np.linalg.LinAlgError, ArithmeticError) as error:
            start, stop = self._samples[0].time, self._samples[-1].time
            self.proposal = no_proposal(self._task, start, stop, str(error))
        if self.proposal.has_gains:
            self._current = np.array([self.proposal.gains[name] for name in self._schedule.names])
        self.write_error = self._output.write(self.proposal)

    def _stretch(self) -> Stretch:
        """Return the stretch that is kept, evenly sampled.

        Raises:
            InputError: it has gaps, or speed or heading changed in it.
        """
        record = self._record()
        _refuse_unsteady(record)
        period = natural_period(self._task.loop)
        rate = min(RATE / period, require_stream(self._trial).rate)
        time = np.arange(record.time[0], record.time[-1], 1.0 / rate)
        columns = [_evenly(record, name, time, _LONGEST_GAP * period) for name in _channels(self._task)]
        U = float(np.nanmean(record["u"])) if "u" in record else self._task.U
        return Stretch(float(time[0]), 1.0 / rate, np.column_stack(columns), U)

    def _record(self) -> Record:
        time = np.array([sample.time for sample in self._samples])
        values = np.array([sample.values for sample in self._samples])
        raw = record_from_values("stretch", require_stream(self._trial).layout, time, values)
        return canonical_record(raw, self._trial.reference_point)


def _channels(task: TuningTask) -> tuple[str, str]:
    return task.loop.output, task.loop.actuator


def _evenly(record: Record, name: str, time: Array, longest_gap: float) -> Array:
    """Return a channel at times (n,), linear between its readings.

    Raises:
        InputError: there is none for longer than the gap [s].
    """
    is_read = np.isfinite(record[name])
    read = record.time[is_read]
    gap = float(np.max(np.diff(read, prepend=record.time[0], append=record.time[-1])))
    if gap > longest_gap:
        raise InputError(f"'{name}' has a gap of {gap:.2g} s in the stretch; {longest_gap:.2g} s are bridged")
    return np.interp(time, read, record[name][is_read])


def _refuse_unsteady(record: Record) -> None:
    """Refuse a stretch in which speed or heading changed, as far as they are in the stream."""
    if "u" in record:
        mean, rms = float(np.nanmean(record["u"])), float(np.nanstd(record["u"]))
        if rms > _STEADY_SPEED * abs(mean):
            raise InputError(f"the speed is not steady, {mean:.3g} m/s with {rms:.2g} m/s rms in the stretch")
    if "psi" in record:
        psi = record["psi"][np.isfinite(record["psi"])]
        rms = float(np.std(np.unwrap(psi)))
        if rms > _STEADY_HEADING:
            raise InputError(f"the craft turned in the stretch: its heading moved by {math.degrees(rms):.0f} deg rms")


def _refuse_unsuitable(task: TuningTask, settings: ProposalSettings, rate: float) -> None:
    """Refuse loops, stretches and rates of which no sea can be estimated."""
    sea = next((met for met in task.disturbances if isinstance(met, Seaway)), None)
    if task.demand is not None or sea is None or sea.path is not None:
        raise InputError(
            f"proposal.loop: the loop on '{task.loop.output}' is no roll stabiliser in a sea, and its plant is not the "
            "model that is followed; name the loop file of the fins, or one whose [plant] model is the stream's"
        )
    period = natural_period(task.loop)
    if settings.stretch_s < SHORTEST_PERIODS * period:
        raise InputError(
            f"proposal.stretch_s = {settings.stretch_s:g} s holds too few swings of {period:.3g} s; make it "
            f"{math.ceil(SHORTEST_PERIODS * period):d} or more"
        )
    if rate * period < _SLOWEST_RATE:
        raise InputError(
            f"follow.rate = {rate:g} Hz does not resolve swings of {period:.3g} s; send {_SLOWEST_RATE / period:.2g} "
            "Hz or more"
        )


def _refuse_missing_channels(task: TuningTask, rest: Record) -> None:
    if missing := [name for name in _channels(task) if name not in rest]:
        raise InputError(
            f"[follow] lacks '{missing[0]}': gains of the loop from '{task.loop.actuator}' on '{task.loop.output}' are "
            "proposed from both; add its column to [follow.channels]"
        )
