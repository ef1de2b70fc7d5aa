"""The outer loop of track keeping as a tuning of its own: from the distance to the heading order."""

from dataclasses import replace

from seatrial.control.task import OUTPUT, Seaway, SlowDisturbance, TrackDemand, TuningTask
from seatrial.control.track.paths import CURRENT, EAST, HeadingLoop
from seatrial.core.results.tuning import ControllerConstraints
from seatrial.core.values import InputError, Parameter, Parameters
from seatrial.physics.loops import Block, Term, TransferLoop
from seatrial.physics.loops.autopilot import lag_frequency
from seatrial.physics.simulate.craft_control import LineOfSight

# crossover U KP of the outer loop over the lag frequency of the heading loop: least, first, largest; chosen
_SLOWEST, _START, _FASTEST = 0.003, 0.1, 1.0
_INTEGRAL_SHARE = 0.2  # of the crossover, the largest KI / KP; chosen
_STRONGEST = 2.0  # the strongest current in its rms: 95 % of a Gaussian's are weaker
_SOURCE = "bandwidth of the heading loop"


def refuse_impossible_track(task: TuningTask, track: TrackDemand) -> None:
    """Refuse a track without an identified model of heading and position, or in a current as fast as the craft."""
    ship = task.trimmed_ship
    if ship is None or task.loop.output != "psi" or EAST not in ship.model.states:
        raise InputError(
            "track: a track is kept by a heading loop on an identified model with heading and position; give "
            "plant.model of such a model, or leave [track] out"
        )
    if not largest_integral_gain(task, track) > 0.0:
        raise InputError(
            f"track.current = {track.current:.3g} m/s is at times {_STRONGEST * track.current:.3g} m/s, no less than "
            f"the craft's {task.U:.3g} m/s: no track can be kept in it; give a slower one"
        )


def largest_integral_gain(task: TuningTask, track: TrackDemand) -> float:
    """Return the speed of the craft less that of the strongest current [m/s].

    Up to it sigma keeps the track stable from any distance (Caharija et al. 2016, IEEE Trans. Control Syst. Technol.
    24, 1623-1642).
    """
    return task.U - _STRONGEST * track.current


def heading_loop_of(task: TuningTask, loop: TransferLoop) -> HeadingLoop:
    """Return the heading loop that a track is kept with, of a task that `refuse_impossible_track` accepts."""
    assert task.trimmed_ship is not None
    return HeadingLoop(task.trimmed_ship, loop)


def track_disturbances(
    task: TuningTask, heading: HeadingLoop, track: TrackDemand
) -> tuple[Seaway | SlowDisturbance, ...]:
    """Return what disturbs the heading loop, carried to the track, and the current across it."""
    current = SlowDisturbance(
        track.current, track.bandwidth, task.U, "m/s", "of current across the track", CURRENT.track
    )
    carried = (
        replace(met, path=heading.disturbance_to_track(heading.waves if isinstance(met, Seaway) else heading.rudder))
        for met in task.disturbances
    )
    return (current, *carried)


def track_task(task: TuningTask, heading: HeadingLoop, track: TrackDemand) -> TuningTask:
    """Return the tuning of the distance from a track by the heading order, KP = 1 / Delta and KI = sigma / Delta^2.

    That is what line of sight with an integral is for small distances (Borhaug, Pavlov & Pettersen 2008, Proc. 47th
    IEEE CDC, 4984-4991, linearised).
    """
    plant = heading.order_to_track()
    scale = lag_frequency(plant) / task.U
    most = _FASTEST * scale
    gains = (
        Parameter("KP", _START * scale, "rad/m", _SLOWEST * scale, most, free=True, source=_SOURCE,
                  meaning="1 / lookahead distance"),
        Parameter("KI", 0.0, "rad/(m s)", 0.0, _INTEGRAL_SHARE * most**2 * task.U, free=True, source=_SOURCE,
                  meaning="integral gain over the square of the lookahead distance"),
    )  # fmt: skip
    terms = (Term("KP", Block("proportional")), Term("KI", Block("integral", (1.0,), (1.0, 0.0))))
    loop = TransferLoop("track", (), terms, (), (), plant, CURRENT.track, Parameters(gains), EAST, "psi", "disturbance")
    return TuningTask(
        question="",
        name="track",
        plant="",
        loop=loop,
        disturbances=track_disturbances(task, heading, track),
        objectives=(OUTPUT,),
        constraints=ControllerConstraints(Ms=task.constraints.Ms),
        U=task.U,
    )


def line_of_sight(gains: tuple[float, float], rate: float) -> LineOfSight:
    """Return the guidance whose linear part has gains KP [rad/m] and KI [rad/(m s)]."""
    KP, KI = gains
    return LineOfSight(1.0 / KP, KI / KP**2, rate)
