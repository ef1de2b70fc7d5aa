"""A trial file drafted from logs: every guess with its evidence, what is unsure as a commented line."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from seatrial.core.values import InputError, Record
from seatrial.core.values.errors import listed
from seatrial.data.draft.behaviour import checked_by_behaviour, run_record, tells_wind, with_wind_role
from seatrial.data.draft.column_guess import ColumnGuess, agreed_guesses, with_velocities_of_antenna
from seatrial.data.draft.draft_text import (
    ASSUMED,
    NO_ANTENNA,
    OPEN_SPEED,
    RecordsBlock,
    known_unneeded,
    tables_text,
    trial_text,
    unrecognised_columns,
)
from seatrial.data.draft.guess import (
    NOZZLE,
    guess_columns,
    with_columns_of_turning,
    with_turned_thruster,
    without_conflicts,
    without_depth,
)
from seatrial.data.draft.held_out import (
    NOTHING_HELD_OUT,
    HeldOutRuns,
    can_judge,
    heels_apart,
    held_out_runs,
    unlike_decays_text,
)
from seatrial.data.draft.manoeuvres import (
    autopilot_modes,
    changes_course,
    find_stretches,
    numbered,
    offered_parts,
    parts_without_gaps,
    two_thirds_and_a_third,
)
from seatrial.data.draft.naming import CHANNELS, NOTHING_STATED, StatedColumns
from seatrial.data.draft.runs_of_logs import (
    LogRun,
    OtherSpeed,
    is_one_place,
    runs_by_speed,
    runs_of_logs,
    session_line,
    stated_options,
)
from seatrial.data.draft.ship_estimates import (
    UNSTATED,
    HeaderSize,
    StatedSize,
    is_in_basin,
    may_be_in_fresh_water,
    sizes_in_header,
)
from seatrial.data.draft.starting_model import (
    StartingModel,
    in_a_current,
    is_rate_steady,
    share_current,
    starting_model,
    thinned_rate,
    with_wind,
)
from seatrial.data.draft.stretches import DECAY, STRAIGHT, LogStretch, used_parts
from seatrial.data.draft.survey import (
    ColumnSummary,
    LogSurvey,
    apart_by_sheet,
    columns_by_source,
    survey_logs,
    with_common_ranges,
)
from seatrial.data.trial.plausibility import ESTIMATED
from seatrial.data.trial.records import need_release
from seatrial.data.trial.run_data import run_name

_HEADINGS = (-180.0, 360.0)  # deg, between which a heading lies; ours
_HARD_OVER = 45.0  # deg, beyond which no rudder goes; chosen
_WIDER_THAN_A_STATE = 6.0  # range of a column, up to which it may number states, such as those of a fix; chosen
_MIXED = "mixed"  # kind of a run that holds several manoeuvres, or none that is recognised; ours
_CALM = 0.1  # of the largest range of a run's waves, below which another run lies in calm water; chosen
_CALM_REASON = "no waves in it: decays in calm water make a trial of their own"
_RUNS_EXAMINED = 6  # the longest, whose motion is compared with the guesses; chosen: some show what others do not


@dataclass(frozen=True, eq=False)
class DraftTrial:
    """A drafted trial file.

    Attributes:
        text: the TOML file.
        surveys: the logs, in order.
        runs: which of them belong together.
        guesses: of the columns of each source of the longest run.
        records: of each run, even and complete; None where its columns make none.
        stretches: manoeuvres found, of each run; parts: those of them that are runs of their own.
        held_out: the runs that judge the model; empty: none can.
        unrecognised: columns of the longest run that stand for nothing that is known.
        not_needed: those that are known and stand for no channel, with the reason.
        other_speeds: decays and runs in waves that are left out, a trial of their own for each speed.
        unlike_decays: which roll decays die out faster than the others; empty: none.
        session: the line that says which runs share their offsets; empty: each has its own.
        header_sizes: what the header of the longest run says of the craft and what is not stated.
        lacks_density: whether its water is taken for that of the sea, and the craft is often tried in fresh water.
        lacks_length: whether the length of the craft is to be stated.
        lacks_input: whether no column is an input of a model.
        left_out: files that are no runs of the trial, with the reason; not those of `other_speeds`.
    """

    text: str
    surveys: tuple[LogSurvey, ...]
    runs: tuple[LogRun, ...]
    guesses: tuple[tuple[ColumnGuess, ...], ...]
    records: tuple[Record | None, ...] = ()
    stretches: tuple[tuple[LogStretch, ...], ...] = ()
    parts: tuple[tuple[LogStretch, ...], ...] = ()
    held_out: HeldOutRuns = NOTHING_HELD_OUT
    unrecognised: tuple[str, ...] = ()
    not_needed: Mapping[str, str] = field(default_factory=dict)
    other_speeds: tuple[OtherSpeed, ...] = ()
    unlike_decays: str = ""
    session: str = ""
    header_sizes: tuple[HeaderSize, ...] = ()
    lacks_density: bool = False
    lacks_length: bool = False
    lacks_input: bool = False
    left_out: Mapping[Path, str] = field(default_factory=dict)

    @property
    def estimated(self) -> tuple[str, ...]:
        """Keys of the file whose numbers nobody measured, each once."""
        return self._marked(ESTIMATED)

    @property
    def lacks_heading(self) -> bool:
        """Whether what steers or a track is recorded and no heading is recognised, without which none shows drift."""
        symbols = {g.symbol for part in self.guesses for g in part if g.is_used}
        moves = any(symbol == "delta" or symbol.startswith(("command_", "rpm_")) for symbol in symbols)
        return (moves or bool(symbols & {"lat", "x0", "cog"})) and not symbols & {"psi", "psi_magnetic", "q_w"}

    @property
    def column_like_heading(self) -> str:
        """The name of the column that may be the heading where it is missing; empty where none may.

        Of those that are not recognised the one of the widest range within what the angle can be, in degrees.
        """
        low, high = _HEADINGS
        likely = {c.name: c.high - c.low for c in self._unrecognised_columns if low <= c.low and c.high <= high}
        widest = max(likely, key=lambda name: likely[name], default="")
        return widest if likely.get(widest, 0.0) > _WIDER_THAN_A_STATE else ""

    @property
    def column_like_rudder(self) -> str:
        """The name of the first column that may be the rudder where no input is recognised; empty where none may.

        Of those that are not recognised one that goes to either side, no farther than rudders do, in degrees.
        """
        return next(
            (c.name for c in self._unrecognised_columns if -_HARD_OVER <= c.low < 0.0 < c.high <= _HARD_OVER), ""
        )

    @property
    def _unrecognised_columns(self) -> Iterator[ColumnSummary]:
        columns = (
            one for run in self.runs for source in run.sources for topic in source.topics for one in topic.columns
        )
        return (column for column in columns if column.name in self.unrecognised)

    @property
    def lacks_manoeuvre(self) -> bool:
        """Whether a rudder is recorded and all runs are straight courses, which show nothing of what it does."""
        has_rudder = any(g.symbol == "delta" for part in self.guesses for g in part if g.is_used)
        return has_rudder and all(self.stretches) and all(s.kind == STRAIGHT for run in self.stretches for s in run)

    @property
    def lacks_antenna(self) -> bool:
        """Whether a receiver shows the track, and neither its log nor anybody says where its antenna stands."""
        return NO_ANTENNA in self.text

    @property
    def lacks_speed(self) -> bool:
        """Whether the speed through the water is to be stated: fixes on one course do not show it."""
        return OPEN_SPEED in self.text

    @property
    def assumed(self) -> tuple[str, ...]:
        """Keys of the file that hold what is usual."""
        return self._marked(ASSUMED)

    def _marked(self, mark: str) -> tuple[str, ...]:
        lines = (line.partition("=") for line in self.text.splitlines() if f"{mark}: " in line)
        return tuple(dict.fromkeys(key.strip() for key, sign, _ in lines if sign and not key.startswith("#")))

    @property
    def open_questions(self) -> tuple[ColumnGuess, ...]:
        """The columns for which a person must choose; not wind."""
        return tuple(g for part in self.guesses for g in part if g.is_used and g.is_open and not g.is_of_wind)


def draft_trial(
    *logs: str | Path,
    folder: str | Path = ".",
    size: StatedSize = UNSTATED,
    stated: StatedColumns = NOTHING_STATED,
) -> DraftTrial:
    """Draft a trial file for logs: files, or folders whose logs are taken.

    Args:
        logs: which of them are runs, and which are sources of one run, follows from kind, clock and name.
        folder: where the trial file will lie; the paths in it count from there.
        size: what is stated of the craft; without a length the file asks for it.
        stated: what columns are, by their headings.

    Raises:
        InputError: no logs, one that cannot be read, or no column that is recognised.
    """
    surveyed = survey_logs([Path(log) for log in logs], stated)
    surveys = surveyed.logs
    _refuse_unwritable_names(surveys)
    runs = runs_of_logs(with_common_ranges(apart_by_sheet(surveys)))
    used = {survey.path for run in runs for survey in run.sources}
    left_out = dict(surveyed.left_out)
    left_out |= {one.path: "it is of another kind than the runs" for one in surveys if one.path not in used}
    named = _named_columns(runs, size)
    _refuse_nothing_recognised(surveys, named)
    left_out |= _calm_runs(surveys, runs, named)
    runs = [run for run in runs if run.sources[0].path not in left_out]
    others = _other_speeds(runs, named, size, stated)
    at_other_speeds = {path: one.reason for one in others for path in one.logs}
    runs = [run for run in runs if run.sources[0].path not in at_other_speeds]
    named = _named_columns(runs, size)
    longest = sorted(range(len(runs)), key=lambda k: -runs[k].duration)[:_RUNS_EXAMINED]
    examined = [checked_by_behaviour(runs[k].sources, named[k]) for k in longest]
    guesses = [agreed_guesses(parts, examined) for parts in named]
    records = [run_record(run.sources, parts) for run, parts in zip(runs, guesses, strict=True)]
    guesses = with_velocities_of_antenna(guesses, records, size.antenna)
    stretches = numbered([find_stretches(run.sources, one) for run, one in zip(runs, records, strict=True)])
    turned = [with_turned_thruster(parts, is_rate_steady=is_rate_steady(records)) for parts in guesses]
    if turned != guesses:
        guesses, records = turned, [run_record(run.sources, parts) for run, parts in zip(runs, turned, strict=True)]
    symbols = {g.symbol for one in guesses[longest[0]] for g in one if g.is_used}
    has_jet = any(NOZZLE.search(str(g.source)) for one in guesses[longest[0]] for g in one if g.symbol == "delta")
    model = starting_model(symbols, records, size, has_jet=has_jet)
    # whatever a craft with thrusters does shows them: its runs stay whole where one can judge the others
    parts = _thruster_parts(runs, records, stretches) if model.has_thrusters else offered_parts(records, stretches)
    pieces = _pieces(runs, records, parts)
    model = starting_model(symbols, list(pieces.values()), size, has_jet=has_jet) if pieces else model
    has_wind = model.has_propeller and tells_wind(guesses[longest[0]])
    model = with_wind(model, size) if has_wind else model
    guesses = [with_wind_role(parts, is_taken=has_wind) for parts in guesses]
    guesses = guesses if model.is_in_shallow_water else [without_depth(parts) for parts in guesses]
    held_out = held_out_runs(model, pieces, _kinds(runs, stretches, parts))
    is_model_test = model.has_forces_of_a_ship and is_in_basin((g for one in guesses[longest[0]] for g in one), size)
    if not is_model_test:
        model = in_a_current(model, symbols, list(pieces.values()))
    session = session_line(
        runs, is_in_basin=is_model_test, is_one_place=is_one_place(runs, guesses) and share_current(records)
    )
    shows_all = model.has_thrusters or changes_course(stretches[0])
    if shows_all and len(runs) == 1 and records[0] is not None and not held_out.has_several:
        parts, held_out = _in_two(model, runs, records[0], stretches[0]) or (parts, held_out)
    blocks = _blocks(runs, guesses, stretches, parts, longest[0])
    is_released = model.swings and need_release(list(pieces.values()))
    blocks = [
        replace(_with_roles(block, model, held_out, session), antenna=size.antenna, is_released=is_released)
        for block in blocks
    ]
    rate = thinned_rate(records, size.length, model.speed)
    decays = _decays(runs, records, stretches) if model.rolls else {}
    columns_of_longest = [g for _, columns in blocks[0].sources for g in columns]
    tables = tables_text(
        model,
        columns_of_longest,
        size,
        rate,
        heels_apart(decays),
        _largest_rates(runs[longest[0]], guesses[longest[0]]),
    )
    text = trial_text(blocks, tables, {**at_other_speeds, **left_out}, Path(folder).resolve())
    has_density = "\nrho = " in text or "in sea water" in text
    return DraftTrial(
        text, surveys, tuple(runs), guesses[longest[0]], tuple(records), stretches, parts, held_out,
        tuple(name for source in blocks[0].sources for name in unrecognised_columns(*source)),
        {name: why for source in blocks[0].sources for name, why in known_unneeded(*source).items()}, others,
        unlike_decays_text(decays), session,
        sizes_in_header(runs[longest[0]].sources[0], size), has_density and may_be_in_fresh_water(size),
        bool(model.name) and not size.length, not model.name, left_out,
    )  # fmt: skip


def _largest_rates(run: LogRun, parts: Sequence[Sequence[ColumnGuess]]) -> dict[str, float]:
    """The largest reading of each column that is the rate of a thruster, of all logs with the same columns."""
    return {
        guess.symbol: columns_by_source(source)[guess.source][1].high
        for source, part in zip(run.sources, parts, strict=True)
        for guess in part
        if guess.is_used and guess.symbol.startswith("rpm_")
    }


def _named_columns(runs: Sequence[LogRun], size: StatedSize) -> list[list[tuple[ColumnGuess, ...]]]:
    """What the columns of each source of each run are, by their names, and where these say nothing by the heading."""
    named = [without_conflicts([guess_columns(source, size.gear) for source in run.sources]) for run in runs]
    return [with_columns_of_turning(run.sources, parts) for run, parts in zip(runs, named, strict=True)]


def _other_speeds(
    runs: Sequence[LogRun],
    named: Sequence[Sequence[Sequence[ColumnGuess]]],
    size: StatedSize,
    stated: StatedColumns,
) -> tuple[OtherSpeed, ...]:
    """The decays and runs in waves that are left out, by their speed: all but those of the speed with the most."""
    symbols = {g.symbol for run in named for part in run for g in part if g.is_used}
    model = starting_model(symbols, ())
    if not (model.swings or model.has_waves):
        return ()
    return tuple(
        OtherSpeed(speed, tuple(run.sources[0].path for run in group), stated_options(size, stated))
        for speed, group in runs_by_speed(runs)[1:]
    )


def _calm_runs(
    surveys: Sequence[LogSurvey], runs: Sequence[LogRun], named: Sequence[Sequence[Sequence[ColumnGuess]]]
) -> dict[Path, str]:
    """The runs in calm water beside others in waves, with the reason why they are left out."""
    if not starting_model({g.symbol for run in named for part in run for g in part if g.is_used}, ()).has_waves:
        return {}
    own = {survey.path: columns_by_source(survey) for survey in surveys}  # ranges of each log, not those of all
    spans = {
        source.path: own[source.path][guess.source][1].high - own[source.path][guess.source][1].low
        for run, parts in zip(runs, named, strict=True)
        for source, part in zip(run.sources, parts, strict=True)
        for guess in part
        if guess.is_used and guess.symbol == "zeta"
    }
    largest = max(spans.values(), default=0.0)
    return {path: _CALM_REASON for path, span in spans.items() if span < _CALM * largest}


def _refuse_nothing_recognised(
    surveys: Sequence[LogSurvey], named: Sequence[Sequence[Sequence[ColumnGuess]]]
) -> None:  # fmt: skip
    """Raises:
    InputError: no column of any log stands for a channel; which there are, and how they are stated.
    """
    has_times = any(topic.time is not None for survey in surveys for topic in survey.topics)
    if not has_times or any(guess.is_used for run in named for part in run for guess in part):
        return
    names = unrecognised_columns(surveys[0], ())
    if names:
        raise InputError(
            f"no column of '{surveys[0].path.name}' is recognised by its heading: {listed(names)}; say what they "
            f"are, as in --column '{names[0]}=psi'; channels are {CHANNELS}"
        )


def _refuse_unwritable_names(surveys: Sequence[LogSurvey]) -> None:
    """Raises:
    InputError: a file's name is of another encoding.
    """
    for survey in surveys:
        try:
            str(survey.path).encode()
        except UnicodeEncodeError:
            raise InputError(f"'{survey.path}' is no name in UTF-8, as a trial file needs it; rename it") from None


def _pieces(
    runs: Sequence[LogRun], records: Sequence[Record | None], parts: Sequence[Sequence[LogStretch]]
) -> dict[str, Record]:
    """The record of each run of the trial, whole or cut out of its log; empty where one of them cannot be read."""
    pieces = dict[str, Record]()
    for run, record, offered in zip(runs, records, parts, strict=True):
        if record is None:
            return {}
        origin = float(record.time[0])
        cut = {
            used_part.name: record.between(origin + used_part.start, origin + used_part.stop)
            for used_part in used_parts(offered)
        }
        pieces |= cut or {_whole_name(run): record}
    return pieces


def _thruster_parts(
    runs: Sequence[LogRun], records: Sequence[Record | None], stretches: Sequence[Sequence[LogStretch]]
) -> tuple[tuple[LogStretch, ...], ...]:
    """The parts of the only log, of which nothing is left out; none of several, which stay whole."""
    if len(runs) > 1 or records[0] is None:
        return tuple(() for _ in runs)
    return (parts_without_gaps(records[0], stretches[0], autopilot_modes(runs[0].sources, records[0])),)


def _kinds(
    runs: Sequence[LogRun], stretches: Sequence[Sequence[LogStretch]], parts: Sequence[Sequence[LogStretch]]
) -> dict[str, str]:
    """The kind of manoeuvre of each run of the trial; of a whole one with several, that it is mixed."""
    kinds = dict[str, str]()
    for run, found, offered in zip(runs, stretches, parts, strict=True):
        whole = found[0].kind if len(found) == 1 else _MIXED
        cut = {used_part.name: used_part.kind for used_part in used_parts(offered)}
        kinds |= cut or {_whole_name(run): whole}
    return kinds


def _whole_name(run: LogRun) -> str:
    return run.name or run_name(run.sources[0].path)


def _decays(
    runs: Sequence[LogRun], records: Sequence[Record | None], stretches: Sequence[Sequence[LogStretch]]
) -> dict[str, Record]:
    """The roll decays by name, each from its release; those of a log with several by the names of these."""
    decays = dict[str, Record]()
    for run, record, found in zip(runs, records, stretches, strict=True):
        if record is None:
            continue
        for one in (stretch for stretch in found if stretch.kind == DECAY):
            origin = float(record.time[0])
            name = _whole_name(run) if len(found) == 1 else one.name
            decays[name] = record.between(origin + one.start, origin + one.stop)
    return decays


def _in_two(
    model: StartingModel, runs: Sequence[LogRun], record: Record, stretches: Sequence[LogStretch]
) -> tuple[tuple[tuple[LogStretch, ...], ...], HeldOutRuns] | None:
    """Return the parts of the only log, a third of it held out whose orders the rest holds; nothing is left out.

    Whatever a craft with thrusters does shows these, and every change of course a rudder. None where no third can be
    held out, or an autopilot's modes cut the log.
    """
    if len(autopilot_modes(runs[0].sources, record)) > 1:
        return None
    for is_last in (True, False):
        parts = (two_thirds_and_a_third(record, stretches, is_last=is_last),)
        name = parts[0][1 if is_last else 0].name
        if can_judge(model, name, _pieces(runs, [record], parts)):
            held_out = HeldOutRuns((name,), "a third of the manoeuvres; what is ordered in it the rest holds, too")
            return parts, held_out.timed(_pieces(runs, [record], parts))
    return None


def _blocks(
    runs: Sequence[LogRun],
    guesses: Sequence[tuple[tuple[ColumnGuess, ...], ...]],
    stretches: Sequence[tuple[LogStretch, ...]],
    parts: Sequence[tuple[LogStretch, ...]],
    longest: int,
) -> list[RecordsBlock]:
    """One block for files of one kind, else one for each run."""
    if runs[0].name:
        return [
            RecordsBlock(run.name, tuple(zip(run.sources, columns, strict=True)), (), (found,), (offered,))
            for run, columns, found, offered in zip(runs, guesses, stretches, parts, strict=True)
        ]
    files = tuple(run.sources[0] for run in runs)
    return [RecordsBlock("", ((files[longest], guesses[longest][0]),), files, tuple(stretches), tuple(parts))]


def _with_roles(block: RecordsBlock, model: StartingModel, held_out: HeldOutRuns, session: str) -> RecordsBlock:
    """The block with the runs that judge the model, and its session."""
    names = [block.name, *(run_name(file.path) for file in block.files)]
    names += [one.name for offered in block.parts for one in offered]
    return replace(
        block,
        validate=replace(held_out, names=tuple(name for name in held_out.names if name in names)),
        session=session,
        has_waves=model.has_waves,
    )
