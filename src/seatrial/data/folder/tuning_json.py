"""A tuned controller as strict JSON: the one source of its documented schema. SI units and radians; null for none."""

from typing import Any

import numpy as np
from pydantic import Field

from seatrial.core.results.tuning import Controller, ParetoFront, SeawaySimulation, Tuning
from seatrial.core.values import Array
from seatrial.data.folder.fit_entries import Entry, Number
from seatrial.data.folder.fit_json import FindingEntry, finding_entry

FORMAT = 1


class ComponentEntry(Entry):
    """A block of the chosen loop: num(s) / den(s), coefficients of s [rad/s] with the highest power first."""

    role: str = Field(description="sensor, term, filter, servo, plant, disturbance")
    name: str
    num: list[float]
    den: list[float]
    gain: str = Field(description="name of the gain that multiplies a term; empty for other blocks")
    source: str


class RestrictionEntry(Entry):
    """What every controller must keep."""

    Ms: Number = Field(description="largest Ms")
    saturation: Number = Field(description="largest share of actuator amplitudes beyond its limit")
    rate_saturation: Number = Field(description="largest share of rate amplitudes beyond its rate")
    limit: Number = Field(description="of the actuator, SI; null: none")
    rate: Number = Field(description="of the actuator, SI per second; null: none")
    stall: Number = Field(description="of the actuator, SI; null: none")


class ControllerEntry(Entry):
    """One set of gains and what linear theory says of it."""

    name: str
    gains: dict[str, float]
    objectives: dict[str, Number]
    rms: dict[str, Number] = Field(description="of output, actuator, actuator_rate, SI, mean square over the seas")
    reduction: Number = Field(
        description="of the output's rms against no control, 0 to 1; null: nothing to compare with"
    )
    Ms: Number = Field(description="Ms, the largest |S|; null: unstable")
    gain_margin: Number = Field(description="factor by which the loop gain may grow; null: any")
    phase_margin: Number = Field(description="rad; null: the loop gain never crosses one")
    delay_margin: Number = Field(description="s of dead time that the loop bears; null: any")
    damping: Number = Field(description="least damping ratio of a closed-loop pole")
    saturation: Number = Field(description="share of actuator amplitudes beyond the limit, worst of the seas")
    rate_saturation: Number = Field(description="the same of rate amplitudes")
    violated: list[str] = Field(description="restrictions not kept, in words; empty: feasible")
    omega: list[float] = Field(description="rad/s at which the open loop is given")
    open_loop: list[tuple[Number, Number]] = Field(description="L there, real and imaginary part; S = 1 / (1 + L)")


class FrontEntry(Entry):
    """Controllers of which none is better than another in all objectives; one line of each list for each controller."""

    name: str
    gain_names: list[str] = Field(description="of the gains, columns of `gains`")
    gains: list[list[float]]
    objectives: list[list[Number]] = Field(description="columns in the order of the document's `objectives`")
    Ms: list[Number] = Field(description="Ms")
    evaluations: int
    hypervolume: Number = Field(description="over that of a brute-force grid; null: no grid")


class SailedEntry(Entry):
    """One controller in nonlinear simulation: reductions of the output's rms, 0 to 1, one for each seed."""

    name: str
    linear: list[Number] = Field(description="without limits")
    limited: list[Number] = Field(description="with limits of angle and rate")
    stalled: list[Number] = Field(description="with stall, too")
    saturation_loss: Number = Field(description="reduction lost to angle and rate limits, mean over the seeds")


class PairedEntry(Entry):
    """Reduction of the chosen controller minus that of another on the same seas, with its 95 % interval."""

    baseline: str
    stage: str
    mean: Number
    lower: Number
    upper: Number
    seeds: int


class SlotEntry(Entry):
    """One condition of the schedule; a cost is the output's rms over that without control."""

    U: float = Field(description="m/s")
    beta: float = Field(description="rad, 0: following sea, pi: head sea")
    height: float = Field(description="significant wave height, m")
    gains: dict[str, float]
    cost: Number
    Ms: Number = Field(description="Ms")
    saturation: Number
    baseline_costs: dict[str, Number] = Field(description="costs of other gains there")
    is_feasible: bool


class BoundEntry(Entry):
    """What no linear controller of its kind does better."""

    name: str
    ratio: Number = Field(description="output variance over that of the reference controller")
    conditions: str = Field(description="what is held equal, the spectrum and the Ms")
    note: str


class ManoeuvreEntry(Entry):
    """One controller carried through a demand by the nonlinear model."""

    name: str
    controller: str
    output: str
    overshoot: Number = Field(description="share of the change")
    settling: Number = Field(description="s to stay within 5 %; null: never")
    stable_draws: int = Field(description="ships drawn from the fit's covariance with a stable loop")
    draws: int
    worst_overshoot: Number = Field(description="over the ships drawn; null: none drawn")


class TuningDocument(Entry):
    """`tuning.json`, and what `seatrial tune --json` writes."""

    format: int = FORMAT
    question: str
    name: str
    plant: str = Field(description="where it comes from, in words")
    seas: list[str] = Field(description="those it is tuned in, in words")
    output: str = Field(description="symbol of what is to stay small")
    actuator: str
    objectives: dict[str, str] = Field(description="name -> unit, in order")
    constraints: RestrictionEntry
    chosen: ControllerEntry = Field(description="the recommendation")
    reasons: list[str]
    baselines: list[ControllerEntry] = Field(description="given gains and other choices")
    front: FrontEntry
    extended_fronts: list[FrontEntry] = Field(description="fronts of more structure")
    components: list[ComponentEntry] = Field(description="blocks of the chosen loop")
    seaway_simulations: list[SailedEntry]
    paired_differences: list[PairedEntry]
    schedule: list[SlotEntry]
    bounds: list[BoundEntry]
    manoeuvres: list[ManoeuvreEntry]
    findings: list[FindingEntry]
    evaluations: int
    status: str = Field(description="how the search ended")
    elapsed_s: float
    versions: dict[str, str]
    seed: int


def tuning_json(tuning: Tuning) -> dict[str, Any]:
    """The documented schema, ready for `strict_json`."""
    document = TuningDocument(
        question=tuning.question,
        name=tuning.name,
        plant=tuning.plant,
        seas=list(tuning.seas),
        output=tuning.output,
        actuator=tuning.actuator,
        objectives=dict(zip(tuning.objectives, tuning.units, strict=True)),
        constraints=RestrictionEntry.model_validate(tuning.constraints),
        chosen=_controller(tuning.chosen, tuning.objectives),
        reasons=list(tuning.reasons),
        baselines=[_controller(rival, tuning.objectives) for rival in tuning.baselines],
        front=_front(tuning.front),
        extended_fronts=[_front(front) for front in tuning.extended_fronts],
        components=[ComponentEntry.model_validate(c) for c in tuning.components],
        seaway_simulations=[_sailed(s) for s in tuning.seaway_simulations],
        paired_differences=[PairedEntry.model_validate(p) for p in tuning.paired_differences],
        schedule=[SlotEntry.model_validate(s) for s in tuning.schedule],
        bounds=[BoundEntry.model_validate(b) for b in tuning.bounds],
        manoeuvres=[ManoeuvreEntry.model_validate(m) for m in tuning.manoeuvres],
        findings=[finding_entry(f) for f in tuning.findings],
        evaluations=tuning.solution.evaluations,
        status=tuning.solution.status.value,
        elapsed_s=tuning.elapsed_s,
        versions=tuning.versions,
        seed=tuning.seed,
    )
    return document.model_dump()


def tuning_schema() -> dict[str, Any]:
    """JSON Schema of `tuning_json`."""
    return TuningDocument.model_json_schema()


def _listed(values: Array) -> list[Any]:
    return np.asarray(values, dtype=np.float64).tolist()


def _controller(c: Controller, objectives: tuple[str, ...]) -> ControllerEntry:
    return ControllerEntry(
        name=c.name,
        gains=c.gains,
        objectives=dict(zip(objectives, _listed(c.objectives), strict=True)),
        rms=c.rms,  # type: ignore[arg-type]
        reduction=c.reduction,
        Ms=c.Ms,
        gain_margin=c.gain_margin,
        phase_margin=c.phase_margin,
        delay_margin=c.delay_margin,
        damping=c.damping,
        saturation=c.saturation,
        rate_saturation=c.rate_saturation,
        violated=list(c.violated),
        omega=_listed(c.omega),
        open_loop=list(zip(_listed(c.open_loop.real), _listed(c.open_loop.imag), strict=True)),
    )


def _front(front: ParetoFront) -> FrontEntry:
    return FrontEntry(
        name=front.name,
        gain_names=list(front.gain_names),
        gains=_listed(front.gains),
        objectives=_listed(front.objectives),
        Ms=_listed(front.Ms),
        evaluations=front.evaluations,
        hypervolume=front.hypervolume,
    )


def _sailed(s: SeawaySimulation) -> SailedEntry:
    return SailedEntry(
        name=s.name,
        linear=_listed(s.linear),
        limited=_listed(s.limited),
        stalled=_listed(s.stalled),
        saturation_loss=s.saturation_loss,
    )
