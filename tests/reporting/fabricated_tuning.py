"""Tunings nobody searched: a fin with everything a page can show, an autopilot, one with next to nothing."""

import math
from collections.abc import Mapping
from dataclasses import replace

import numpy as np

from seatrial.core.results.station import (
    StationCapability,
    StationFront,
    StationKeeping,
    StationMargins,
    StationPrecision,
    StationThruster,
    StationTrial,
)
from seatrial.core.results.tuning import (
    Component,
    Controller,
    ControllerConstraints,
    CornerResponse,
    DisturbanceSimulation,
    ManoeuvreResponse,
    OperatingPoint,
    PairedDifference,
    ParetoFront,
    PerformanceBound,
    Robustness,
    SeawaySimulation,
    TrackKeeping,
    Tuning,
)
from seatrial.core.values import Array, Channel, Finding, Parameter, Parameters, Record, RecordKind, Severity, frozen
from seatrial.numerics.optimise import Solution, Status
from seatrial.physics.loops import Block, Term, TransferLoop, margins
from seatrial.physics.loops.performance import frequency_band
from seatrial.physics.loops.structures import fin_loop

CHOSEN = {"KP": 19.4, "KI": 0.9, "KD": 52.5}
GIVEN = {"KP": 11.053, "KI": 0.428, "KD": 32.736}
LIMITS = ControllerConstraints(2.0, 0.2, 0.2, math.radians(22.0), math.radians(25.0), math.radians(18.0))
SEEDS = 20


def fabricated_fin() -> Tuning:
    """A roll fin: three objectives, two fronts, twenty seeds, 3 x 3 x 2 conditions, bounds, findings."""
    rng = np.random.default_rng(5)
    loop = fin_loop()
    chosen = controller(loop, "chosen", CHOSEN, (math.radians(2.1), math.radians(8.0), math.radians(9.1)), 0.74)
    given = controller(loop, "given", GIVEN, (math.radians(3.0), math.radians(6.2), math.radians(6.4)), 0.62)
    brisk = controller(loop, "least roll", {"KP": 40.0, "KI": 0.0, "KD": 52.0},
                       (math.radians(1.7), math.radians(13.0), math.radians(16.0)), 0.79)  # fmt: skip
    brisk = replace(brisk, violated=("Ms 2.31, 2 allowed", "33 % of the fin's amplitudes beyond 22 deg, 20 % allowed"))
    return Tuning(
        question="Which gains keep it upright without wearing out the fins?",
        name="fin stabiliser, washout",
        plant="roll of the published patrol ship: T 7.52 s, damping ratio 0.159",
        seas=("ITTC 3.3 m, long-crested, 90 deg, 9.26 m/s", "ITTC 3.3 m, short-crested, 135 deg, 9.26 m/s"),
        output="phi",
        actuator="alpha_f",
        objectives={"roll variance": "rad^2", "fin variance": "rad^2", "fin rate variance": "rad^2/s^2"},
        constraints=LIMITS,
        chosen=chosen,
        reasons=(
            "It is the point of the front nearest to the best value of every objective.",
            "Beyond it a per cent less roll costs more than two per cent more fin rate.",
        ),
        baselines=(given, brisk),
        front=_front(rng, "three gains", 140, 1.0, chosen),
        extended_fronts=(_front(rng, "five gains: band-pass and low-pass added", 110, 0.75, chosen),),
        components=components(loop),
        seaway_simulations=tuple(simulated_in_seaway(loop, c) for c in (chosen, given)),
        paired_differences=(
            PairedDifference("given", "limited", 0.071, 0.062, 0.080, SEEDS),
            PairedDifference("given", "stalled", 0.048, -0.004, 0.098, SEEDS),
        ),
        schedule=_schedule(),
        bounds=(
            PerformanceBound(
                "LQ, full information", 0.54, "equal fin rate energy, ITTC 3.3 m", "no controller knows all states"
            ),
            PerformanceBound(
                "convex in Youla's parameter", 0.71, "equal fin rate energy, ITTC 3.3 m, Ms 2", "order 40"
            ),
        ),
        manoeuvres=(),
        robustness=(Robustness("chosen", 1000, 998, math.inf, 8, 8, 1.62, "gain 1.2, time constants 0.9"),),
        findings=(
            Finding(Severity.WARNING, "gain-bound", "KI ends on its lower bound", "0", "Widen the bound, or drop it"),
            Finding(Severity.INFO, "schedule", "The schedule gains most in following seas", "45 deg: .61 to .2"),
        ),
        solution=Solution(np.array(list(CHOSEN.values())), 0.31, Status.CONVERGED, 251_000, (0.9, 0.31), 7),
        seed=7,
        elapsed_s=8.4,
        versions={"seatrial": "0.1.0", "numpy": "2"},
    )


def fabricated_autopilot() -> Tuning:
    """A heading autopilot with two objectives, a course change and a zigzag, ships drawn; no sea, no schedule."""
    rng = np.random.default_rng(8)
    fin, loop = fabricated_fin(), heading_loop()
    rms = (0.0105, 0.0245, 0.0051)
    chosen = controller(loop, "chosen", {"KP": 1.7, "KD": 60.0}, rms, math.nan)
    given = controller(loop, "given", {"KP": 1.0, "KD": 12.0}, rms, math.nan)
    chosen = replace(chosen, objectives=np.array([1.1e-4, 6.0e-4]))
    given = replace(given, objectives=np.array([1.6e-4, 5.4e-4]))
    t = np.linspace(0.0, 1.0, 40)
    front = ParetoFront("two gains", ("KP", "KD"), np.column_stack([0.5 + 3.0 * t, 40.0 * t]),
                  np.column_stack([3e-4 * (1.2 - t) ** 2 + 4e-5, 1.5e-4 + 1.2e-3 * t**2]), 1.2 + 0.5 * t,
                  40_000)  # fmt: skip
    return replace(
        fin, question="", name="heading autopilot", plant="Nomoto model of a tanker, 7 m/s", output="psi",
        actuator="delta", seas=("slow disturbance of 2 deg of the actuator, 0.05 rad/s",),
        objectives={"heading variance": "rad^2", "rudder variance": "rad^2"},
        constraints=replace(LIMITS, Ms=1.7, limit=math.radians(35.0), rate=math.radians(2.3), stall=math.inf),
        chosen=chosen, baselines=(given,), front=front, extended_fronts=(),
        components=components(loop), seaway_simulations=(), paired_differences=(), schedule=(), bounds=(),
        robustness=(),
        disturbance_simulations=(_kept_in_a_slow_disturbance(),),
        manoeuvres=(_course_change(rng, "course change of 20 deg", "chosen", 1.7, 60.0),
                    replace(_course_change(rng, "course change of 20 deg", "given", 1.0, 12.0), draws=0, stable_draws=0,
                            worst_overshoot=math.nan, sampled_outputs=np.empty((0, 0)), settling=math.nan)),
        findings=(), reasons=(), track=fabricated_track(), station=fabricated_station(),
    )  # fmt: skip


def fabricated_track() -> TrackKeeping:
    """A corner of 60 degrees turned in a circle, and a current in which the limits do not matter."""
    t = np.linspace(-60.0, 200.0, 200)
    turn, north = math.radians(60.0), np.where(t < 0.0, 7.0 * t, 7.0 * 0.5 * t)
    east = np.where(t < 0.0, 0.0, 7.0 * 0.866 * t - 12.0 * t * np.exp(-t / 20.0))
    record = Record.from_arrays("corner", t + 60.0, {"x0": north, "y0": east}, RecordKind.SIMULATED)
    rms = {"output": 12.3, "actuator": 0.02, "actuator_rate": 0.002}
    kept = DisturbanceSimulation("current of 0.3 m/s", 8, rms, rms | {"output": 12.1}, rms | {"output": 12.2},
                                 {"output": 0.2, "actuator": 3e-4, "actuator_rate": 3e-5})  # fmt: skip
    corner = CornerResponse(turn, 200.0, 0.3, record, 41.0, 55.0, 99, 100)
    return TrackKeeping(300.0, 1.5, 0.02, 7.0, 1.6, 4.0, math.radians(48.0), 35.0, (kept,), corner)


def fabricated_station() -> StationKeeping:
    """Two thrusters, the current held from every quarter, one draw lost."""
    t, units = np.linspace(0.0, 100.0, 200), (("N/m", "N/m", "N/rad"),) * 3
    record = Record.from_arrays(
        "station", t, {"x0": np.sin(t), "y0": 0.5 * np.cos(t), "psi": 0.1 * np.sin(t)}, RecordKind.SIMULATED
    )
    quarters, thrust = 0.5 * math.pi * np.arange(4), np.array([-40.0, 0.0, 60.0])
    share, inverse = np.array([-1.0, 0.0, 1.0]), np.array([[0.5, 0.0, 0.4]])
    return StationKeeping(
        0.4, 0.7, 1.0, 0.1, np.diag([13.0, 19.5, 5.2]), np.diag([0.46, 0.69, 0.3]), np.diag([45.0, 60.0, 0.0]),
        dict.fromkeys(("KP", "KI", "KD"), units), np.array([0.2, 0.2, 0.15]), 0.1, 0.15, "N", 0.3, ("gusts of 5 N",),
        StationMargins(1.59, 1.42, 1.58, 1.92, 0.92), StationPrecision(0.42, 0.2, 0.05),
        StationFront(*(np.array([0.3, 0.4]) for _ in range(3)), np.array([0.06, 0.05]), 99),
        (StationThruster("bow", inverse, share, thrust), StationThruster("stern", inverse, share, thrust)),
        StationCapability(quarters, np.array([2.0, 1.1, 1.5, 1.1]), np.array([2.0, 1.0, 1.4, 1.0]), np.full(4, 90.0),
                          (("bow",), ("bow", "stern"), (), ())),
        StationTrial(quarters, 0.44, 0.78, 0.26, 0.09, 0.01, np.array([0.08, 0.1]), record, 100, 99, 0.93),
    )  # fmt: skip


def _kept_in_a_slow_disturbance() -> DisturbanceSimulation:
    def rms(output: float, actuator: float, rate: float) -> dict[str, float]:
        return {"output": output, "actuator": actuator, "actuator_rate": rate}

    return DisturbanceSimulation(
        "slow disturbance", 8, rms(0.0105, 0.0245, 0.0051), rms(0.01031, 0.0246, 0.0052), rms(0.011, 0.027, 0.00489),
        rms(0.0002, 0.0005, 0.0001),
    )  # fmt: skip


def heading_loop() -> TransferLoop:
    """Nomoto ship (gain .03 1/s, lag 40 s) under a proportional and a differentiating term."""
    gains = Parameters(tuple(Parameter(name, 1.0, "1", 0.0, 100.0, free=True) for name in ("KP", "KD")))
    ship = Block("rudder to heading", (0.03,), (40.0, 1.0, 0.0), "Nomoto et al. 1957")
    terms = (Term("KP", Block("proportional")), Term("KD", Block("derivative", (1.0, 0.0), (0.5, 1.0))))
    return TransferLoop("heading", (), terms, (), (Block("steering gear", (1.0,), (2.0, 1.0)),), ship, ship, gains,
                        "psi", "delta", "delta")  # fmt: skip


def fabricated_bare() -> Tuning:
    """Everything optional empty."""
    fin = fabricated_fin()
    nothing = replace(fin.front, gains=np.empty((0, 3)), objectives=np.empty((0, 3)), Ms=np.empty(0))
    none = replace(fin.chosen, omega=np.empty(0), open_loop=np.empty(0, complex), Ms=math.inf, rms={})
    return replace(
        fin,
        question="",
        seas=(),
        reasons=(),
        baselines=(),
        chosen=none,
        front=nothing,
        extended_fronts=(),
        components=(),
        seaway_simulations=(),
        paired_differences=(),
        schedule=(),
        bounds=(),
        robustness=(),
        findings=(),
        versions={},
        constraints=ControllerConstraints(),
    )


def controller(
    loop: TransferLoop, name: str, gains: Mapping[str, float], rms: tuple[float, ...], reduction: float
) -> Controller:
    """Margins and frequency response of the loop at those gains; the rest as given."""
    tuned = loop.with_gains(np.array(list(gains.values())))
    known = margins(tuned)
    omega = np.geomspace(*frequency_band(tuned), 600)
    return Controller(
        name, dict(gains), np.square(rms), dict(zip(("output", "actuator", "actuator_rate"), rms, strict=True)),
        reduction, known.Ms, known.gain, known.phase, known.delay, known.damping,
        math.exp(-0.5 * (LIMITS.limit / rms[1]) ** 2), math.exp(-0.5 * (LIMITS.rate / rms[2]) ** 2), (),
        omega, tuned.open_loop(omega),
    )  # fmt: skip


def components(loop: TransferLoop) -> tuple[Component, ...]:
    """All blocks of the loop."""
    kinds = (("sensor", loop.sensor), ("filter", loop.filters), ("servo", loop.servo), ("plant", (loop.plant,)),
             ("disturbance", (loop.disturbance,)))  # fmt: skip
    made = [Component(role, b.name, b.num, b.den, "", b.source) for role, blocks in kinds for b in blocks]
    return (*made, *(Component("term", t.block.name, t.block.num, t.block.den, t.gain, t.block.source)
                     for t in loop.terms))  # fmt: skip


def simulated_in_seaway(loop: TransferLoop, c: Controller) -> SeawaySimulation:
    """Reductions scattered about the linear one, and a sum of waves through the linear loop, the fin cut off."""
    rng, tuned = np.random.default_rng(11), loop.with_gains(np.array(list(c.gains.values())))
    linear = c.reduction + 0.01 * rng.standard_normal(SEEDS)
    t = np.arange(0.0, 600.0, 0.25)
    omega = np.sort(rng.uniform(0.5, 1.4, 40))
    waves = np.exp(1j * (np.outer(t, omega) + np.linspace(0.0, 300.0, 40))) * math.radians(0.9)
    free = loop.disturbance.frequency_response(omega)
    roll, fin = free / (1.0 + tuned.open_loop(omega)), -free / (1.0 + tuned.open_loop(omega)) * tuned.open_loop(omega)
    fin = fin / loop.plant.frequency_response(omega)
    values = {
        "phi": (waves @ roll).real,
        "alpha_f": np.clip((waves @ fin).real, -LIMITS.limit, LIMITS.limit),
        "alpha_w": waves.sum(axis=1).real,
        "phi_uncontrolled": (waves @ free).real,
    }
    channels = {name: Channel(frozen(v), "rad", "body", "starboard") for name, v in values.items()}
    return SeawaySimulation(
        c.name, linear, linear - 0.014, linear - 0.06, Record(c.name, frozen(t), channels, RecordKind.SIMULATED)
    )


def _front(rng: np.random.Generator, name: str, count: int, level: float, chosen: Controller) -> ParetoFront:
    """Points on a bowl through the chosen objectives."""
    a, b = rng.uniform(-1.2, 1.2, (2, count))
    logs = np.column_stack([a, b, -0.6 * (a + b) + 0.25 * (a**2 + b**2)])
    gains = rng.uniform(0.0, 80.0, (count, 3))
    return ParetoFront(name, ("KP", "KI", "KD"), gains, level * chosen.objectives * np.exp(logs),
                 rng.uniform(1.2, 2.0, count), 251_000, 0.98 if level == 1.0 else math.nan)  # fmt: skip


def _schedule() -> tuple[OperatingPoint, ...]:
    made = []
    for height in (2.0, 3.3):
        for U in (7.2, 9.26, 11.3):
            for beta in (45.0, 90.0, 135.0):
                cost = 0.12 + 0.03 * height + 0.002 * abs(beta - 90.0) - 0.004 * U
                others = {"given": min(0.9, 2.1 * cost + 0.003 * (135.0 - beta)), "chosen everywhere": 1.4 * cost}
                gains = {"KP": 40.0 + U, "KI": 0.1 * height, "KD": 0.5 * beta}
                feasible = not (height > 3.0 and beta < 60.0 and U > 11.0)
                made.append(
                    OperatingPoint(U, math.radians(beta), height, gains, cost, 1.8, 0.08 * height, others, feasible)
                )
    return tuple(made)


def _course_change(rng: np.random.Generator, name: str, by: str, KP: float, KD: float) -> ManoeuvreResponse:
    """A Nomoto ship under a PD autopilot with a slow rudder, by Euler steps of half a second."""
    t = np.arange(0.0, 300.0, 0.5)
    gain, lag = 0.03, 40.0
    psi, delta, demand = _simulate_course_change(t, KP, KD, gain, lag)
    spread = rng.uniform(0.75, 1.3, (12, 2))
    drawn = np.stack([_simulate_course_change(t, KP, KD, gain * a, lag * b)[0] for a, b in spread])
    record = Record.from_arrays(name, t, {"psi": psi, "delta": delta}, RecordKind.SIMULATED)
    steps = np.where(t > 0.0, math.radians(20.0), 0.0)
    for what, values in (("demand", steps), ("reference", demand)):
        record = record.with_channel(what, Channel(frozen(values), "rad", "earth", "starboard"))
    change = math.radians(20.0)
    return ManoeuvreResponse(name, by, record, "psi", float(psi.max() / change - 1.0), 96.0, 100, 100,
                     float(drawn.max() / change - 1.0), drawn)  # fmt: skip


def _simulate_course_change(t: Array, KP: float, KD: float, gain: float, lag: float) -> tuple[Array, Array, Array]:
    """Heading, rudder and demand of a course change of 20 deg."""
    dt, psi, r, rudder = t[1] - t[0], 0.0, 0.0, 0.0
    demand = math.radians(20.0) * (1.0 - (1.0 + t / 15.0) * np.exp(-t / 15.0))
    out = []
    for wanted in demand:
        out.append((psi, rudder))
        order = np.clip(KP * (wanted - psi) - KD * r, -LIMITS.limit, LIMITS.limit)
        rudder += float(np.clip(order - rudder, -0.04 * dt, 0.04 * dt))
        psi, r = psi + dt * r, r + dt * (gain * rudder - r) / lag
    return (*np.array(out).T, demand)  # type: ignore[return-value]
