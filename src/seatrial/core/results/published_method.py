"""A published method on a user's records: what its search did, and the package's own estimate it is compared with."""

from dataclasses import dataclass, field
from typing import Annotated

from pydantic import Field

from seatrial.core.results.coefficients import Coefficient, Method
from seatrial.core.results.fields import Number, StoredArray
from seatrial.core.text.words import counted


@dataclass(frozen=True)
class SearchRestart:
    """One search with random numbers of its own."""

    values: Annotated[dict[str, Number], Field(description="coefficient -> SI, at its end")]
    record_rms: Annotated[
        Number, Field(description="root mean square of the weighted residuals over the whole record with these values")
    ]
    evaluations: Annotated[int, Field(description="candidates judged")]
    cpu_s: Annotated[Number, Field(description="processor time, s")]
    history: Annotated[
        tuple[Number, ...],
        Field(description="best fitness after each iteration; judged by one sample each it may rise"),
    ]


@dataclass(frozen=True, eq=False)
class SearchTrack:
    """A stream followed by a search sample by sample, and by the package's own follower; (samples,) each, SI."""

    time: Annotated[StoredArray, Field(description="s on the clock of the stream")]
    measured: Annotated[dict[str, StoredArray], Field(description="channel -> recorded")]
    tracked: Annotated[
        dict[str, StoredArray],
        Field(description="channel -> simulated with the coefficients that the search had at that moment"),
    ]
    reference: Annotated[dict[str, StoredArray], Field(description="the same with those of the package's own follower")]
    values: Annotated[dict[str, StoredArray], Field(description="coefficient -> of the search at that moment")]
    reference_values: Annotated[
        dict[str, StoredArray], Field(description="coefficient -> of the package's own follower at that moment")
    ]


@dataclass(frozen=True)
class Search:
    """A search of coefficients by a population."""

    fitness: Annotated[
        str, Field(description="record, or sample: iteration k judges by sample k", pattern="^(record|sample)$")
    ]
    population: int
    iterations: Annotated[int, Field(description="populations judged by each search at most")]
    bounds: Annotated[
        dict[str, tuple[Number, Number]], Field(description="coefficient -> ends of the range searched, SI")
    ]
    weights: Annotated[dict[str, Number], Field(description="channel -> deviation that counts as 1 in the fitness, SI")]
    evaluations: Annotated[int, Field(description="candidates judged by all restarts")]
    cpu_s: Annotated[Number, Field(description="processor time of all restarts, s")]
    history: Annotated[
        tuple[Number, ...], Field(description="best fitness after each iteration of the restart that is used")
    ]
    used: Annotated[int, Field(description="place of the restart whose values are used, from 0")]
    restarts: tuple[SearchRestart, ...]
    scatter: Annotated[
        dict[str, Number], Field(description="coefficient -> standard deviation over the restarts; empty for one")
    ] = field(default_factory=dict)
    is_interrupted: Annotated[bool, Field(description="whether the user stopped it before all restarts")] = False
    trace: Annotated[
        dict[str, tuple[Number, ...]],
        Field(description="coefficient -> best value after each iteration of the restart that is used, SI"),
    ] = field(default_factory=dict)
    reference_trace: Annotated[
        dict[str, tuple[Number, ...]],
        Field(description="as `trace`, of the package's own follower at the same samples; empty: no stream"),
    ] = field(default_factory=dict)
    track: Annotated[SearchTrack | None, Field(description="null: no stream was followed")] = None

    @property
    def effort(self) -> str:
        """Return how often it was made and how many candidates each judged: ``3 restarts of 8000 evaluations``."""
        counts = sorted({restart.evaluations for restart in self.restarts})
        each = " to ".join(map(str, counts[:1] + counts[1:][-1:]))
        return f"{counted(len(self.restarts), 'restart')} of {each} evaluations"


@dataclass(frozen=True)
class ReferenceEstimate:
    """The package's own estimate from the same records, with its intervals."""

    coefficients: tuple[Coefficient, ...]
    method: Method
    evaluations: Annotated[int, Field(description="of the searches under its final criterion, each with exact slopes")]
    cpu_s: Annotated[Number, Field(description="processor time of the estimate with its intervals, s")]
    rms: Annotated[
        dict[str, dict[str, Number]], Field(description="run -> errors of its simulation, keys as in `Prediction.rms`")
    ]
    record_rms: Annotated[
        Number | None, Field(description="as of a restart, for the package's own values; null: no search")
    ] = None
