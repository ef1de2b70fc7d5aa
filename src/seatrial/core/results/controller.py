"""Controllers of a tuning: one set of gains judged by linear theory, fronts of such, their blocks and bounds."""

from dataclasses import dataclass
from typing import Annotated

from pydantic import Field

from seatrial.core.results.fields import ComplexArray, ListedArray, Number, named_by
from seatrial.core.values import Array


@dataclass(frozen=True)
class Component:
    """One block of the loop: num(s) / den(s), coefficients of s [rad/s], highest power first."""

    role: Annotated[str, Field(description="sensor, term, filter, servo, plant, disturbance")]
    name: str
    num: tuple[float, ...]
    den: tuple[float, ...]
    gain: Annotated[str, Field(description="name of the gain that multiplies a term; empty for other blocks")] = ""
    source: str = ""


@dataclass(frozen=True)
class ControllerConstraints:
    """What every controller must keep."""

    Ms: Annotated[Number, Field(description="largest Ms")] = 2.0
    saturation: Annotated[
        Number, Field(description="largest share of actuator amplitudes beyond its limit (Rayleigh)")
    ] = 0.2
    rate_saturation: Annotated[Number, Field(description="largest share of rate amplitudes beyond its rate")] = 0.2
    limit: Annotated[Number, Field(description="of the actuator, SI; null: none (infinite)")] = float("inf")
    rate: Annotated[Number, Field(description="of the actuator, SI per second; null: none (infinite)")] = float("inf")
    stall: Annotated[Number, Field(description="of the actuator, SI; null: none (infinite)")] = float("inf")


@dataclass(frozen=True, eq=False)
class Controller:
    """One set of gains and what linear theory says of it in the seas of the task."""

    name: Annotated[str, Field(description="chosen, given, fitted baseline and the like")]
    gains: Annotated[dict[str, float], Field(description="name -> value")]
    objectives: Annotated[Array, named_by("objectives"), Field(description="objective -> value, shape (m,)")]
    rms: Annotated[
        dict[str, Number], Field(description="of output, actuator, actuator_rate, SI, mean square over the seas")
    ]
    reduction: Annotated[
        Number,
        Field(description="of the output's rms against no control, 0 to 1; null: nothing to compare with"),
    ]
    Ms: Annotated[Number, Field(description="Ms, the largest |S|; null: unstable")]
    gain_margin: Annotated[Number, Field(description="factor by which the loop gain may grow; null: any")]
    phase_margin: Annotated[Number, Field(description="rad; null: the loop gain never crosses one")]
    delay_margin: Annotated[Number, Field(description="s of dead time until the loop is unstable; null: any")]
    damping: Annotated[Number, Field(description="least damping ratio of a closed-loop pole")]
    saturation: Annotated[
        Number, Field(description="share of actuator amplitudes beyond the limit, worst of the seas, 0 to 1")
    ]
    rate_saturation: Annotated[Number, Field(description="the same of rate amplitudes")]
    violated: Annotated[tuple[str, ...], Field(description="constraints not kept, a phrase each; empty: feasible")]
    omega: Annotated[ListedArray, Field(description="rad/s at which the open loop is given, shape (n,)")]
    open_loop: Annotated[
        ComplexArray, Field(description="L there, real and imaginary part; the sensitivity is 1 / (1 + L)")
    ]


@dataclass(frozen=True, eq=False)
class ParetoFront:
    """Controllers of which none is better than another in all objectives; a row of each array for each."""

    name: Annotated[str, Field(description="three gains and the like")]
    gain_names: Annotated[tuple[str, ...], Field(description="columns of `gains`")]
    gains: Annotated[ListedArray, Field(description="shape (n, g)")]
    objectives: Annotated[ListedArray, Field(description="shape (n, m), columns in the order of the objectives")]
    Ms: Annotated[ListedArray, Field(description="shape (n,)")]
    evaluations: Annotated[int, Field(description="number of controllers evaluated")]
    hypervolume: Annotated[Number, Field(description="of the front over that of a brute-force grid; null: no grid")] = (
        float("nan")
    )
    cpu_s: Annotated[Number, Field(description="CPU time of the search; null: not measured")] = float("nan")


@dataclass(frozen=True, eq=False)
class OperatingPoint:
    """One condition of the schedule; a cost is the output's rms over that without control."""

    U: Annotated[float, Field(description="m/s")]
    beta: Annotated[float, Field(description="rad, 0: following sea, pi: head sea")]
    height: Annotated[float, Field(description="m, significant wave height")]
    gains: dict[str, float]
    cost: Number
    Ms: Number
    saturation: Number
    baseline_costs: Annotated[dict[str, Number], Field(description="name of other gains -> their cost there")]
    is_feasible: bool


@dataclass(frozen=True)
class PerformanceBound:
    """The least output variance that a linear controller of its kind reaches."""

    name: str
    ratio: Annotated[Number, Field(description="output variance over that of the chosen controller")]
    conditions: Annotated[str, Field(description="what is held equal (actuator rate energy), the spectrum and the Ms")]
    note: Annotated[str, Field(description="what it means")]
