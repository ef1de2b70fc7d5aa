"""A stream followed by a published search: its fit stands with the package's own, and the motion it tracked."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from seatrial.core.results.online import Snapshot
from seatrial.core.values import InputError
from seatrial.data.trial import EstimateSettings, SearchFitness, SearchSettings, Trial, load_trial
from seatrial.onboard.follow import FollowResult, follow

SAMPLES, ITERATIONS, RATE = 800, 30, 10.0


def stream_trial(repository: Path, folder: Path, settings: EstimateSettings) -> Trial:
    """The shipped example, its stream cut after eighty seconds."""
    text = (repository / "examples" / "heave_pitch_follow.toml").read_text()
    rows = (repository / "examples" / "heave_pitch" / "voyage_1.csv").read_text().splitlines()[: SAMPLES + 1]
    (folder / "heave_pitch").mkdir()
    (folder / "heave_pitch" / "voyage_1.csv").write_text("\n".join(rows) + "\n")
    held_out = (repository / "examples" / "heave_pitch" / "voyage_held_out.csv").read_text()
    (folder / "heave_pitch" / "voyage_held_out.csv").write_text(held_out)
    path = folder / "trial.toml"
    path.write_text(text)
    return replace(load_trial(path), estimate=settings)


@pytest.fixture(scope="module")
def shown() -> list[Snapshot]:
    return []


@pytest.fixture(scope="module")
def outcome(repository: Path, tmp_path_factory: pytest.TempPathFactory, shown: list[Snapshot]) -> FollowResult:
    search = SearchSettings(population=12, iterations=ITERATIONS, fitness=SearchFitness.SAMPLE)
    settings = EstimateSettings(method="iwho", search=search)
    trial = stream_trial(repository, tmp_path_factory.mktemp("stream"), settings)
    return follow(trial, once=True, seed=2, show=lambda snapshot, _: shown.append(snapshot))


def test_the_fit_holds_search_track_and_the_packages_own_estimate(outcome: FollowResult) -> None:
    fit = outcome.fit
    assert fit is not None
    assert fit.search is not None
    assert fit.reference is not None
    assert fit.method.name == "iwho"
    assert len(fit.search.history) == ITERATIONS
    assert fit.search.evaluations == 12 + (ITERATIONS - 1) * 15
    assert {len(v) for v in (*fit.search.trace.values(), *fit.search.reference_trace.values())} == {ITERATIONS}
    assert all(c.standard_error for c in fit.reference.coefficients if not c.fixed)


def test_the_motion_is_tracked_with_the_coefficients_of_each_moment(outcome: FollowResult) -> None:
    assert outcome.fit is not None
    assert outcome.fit.search is not None
    track = outcome.fit.search.track
    assert track is not None
    assert set(track.measured) == {"z", "theta"}
    # wave forces are known but for some periods at both ends
    assert SAMPLES / 2 < len(track.time) < SAMPLES
    np.testing.assert_allclose(np.diff(track.time), 1.0 / RATE, rtol=1e-6)
    for channel in ("z", "theta"):
        assert np.isfinite(track.tracked[channel]).all()
        assert np.isfinite(track.reference[channel]).all()
        late = track.time > track.time[-1] - 5.0
        assert np.corrcoef(track.measured[channel][late], track.reference[channel][late])[0, 1] > 0.9
    last = {name: values[-1] for name, values in track.values.items()}
    assert last == outcome.fit.params


def test_while_it_runs_the_coefficients_of_the_search_are_shown_without_errors(
    outcome: FollowResult, shown: list[Snapshot]
) -> None:
    assert outcome.snapshot is not None
    assert f"iteration {ITERATIONS} of {ITERATIONS}" in outcome.snapshot.advice
    assert np.isinf(shown[-1].standard_error).all()


@pytest.mark.parametrize(
    ("settings", "sentence"),
    [
        (EstimateSettings(method="svr"), "method 'svr' cannot follow a stream"),
        (
            EstimateSettings(method="iwho", search=SearchSettings()),
            "a stream is searched sample by sample; write fitness",
        ),
    ],
)
def test_what_cannot_follow_is_refused(
    repository: Path, tmp_path: Path, settings: EstimateSettings, sentence: str
) -> None:
    with pytest.raises(InputError, match=sentence):
        follow(stream_trial(repository, tmp_path, settings), once=True)
