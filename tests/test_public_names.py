"""Each public name of `seatrial` does its work on a small case, or refuses bad input in one sentence."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest

import seatrial as st

KEPT = Path(__file__).parent / "data" / "folder"
EXAMPLES = Path(__file__).parents[1] / "examples"
TIME = 0.1 * np.arange(100)


@dataclass(frozen=True)
class Case:
    """What a name is tried with: a folder of its own, a fit, and a record of a zigzag of it."""

    folder: Path

    @property
    def fit(self) -> st.Fit:
        return st.load_fit(KEPT / "earlier_results" / "fit")

    @property
    def model(self) -> st.Model:
        return st.models.nomoto().with_values({"K": 0.15, "T": 8.0})

    @property
    def record(self) -> st.Record:
        return st.simulate(self.model, "zigzag:10/10", duration=60.0)

    @property
    def trial(self) -> Path:
        return EXAMPLES / "heave_pitch_forces.toml"

    def written_record(self) -> Path:
        return st.write_record(self.record, self.folder / "record.csv")


def refuses(call: Callable[[], object], sentence: str) -> bool:
    """Return whether a call refuses its input by this sentence."""
    with pytest.raises(st.InputError, match=sentence):
        call()
    return True


WORKS: dict[str, Callable[[Case], object]] = {
    "Channel": lambda _: st.Channel("u", "m/s", "body", "ahead").unit == "m/s",
    "ColumnSpec": lambda _: st.ColumnSpec("u", "speed", "kn").unit == "kn",
    "Design": lambda _: isinstance(st.load(KEPT / "earlier_results" / "design"), st.Design),
    "EstimateSettings": lambda _: st.EstimateSettings(),
    "Finding": lambda c: all(isinstance(finding, st.Finding) for finding in c.fit.findings),
    "Fit": lambda c: c.fit["Y_v"].standard_error > 0.0 and "Y_v" in str(c.fit.summary()),
    "InputError": lambda _: issubclass(st.InputError, Exception),
    "Layout": lambda _: st.Layout("text", st.ColumnSpec("time", "t", "s"), (st.ColumnSpec("u", "u", "m/s"),)),
    "Model": lambda c: c.model.states == ("psi", "r") or c.model.states,
    "Parameters": lambda c: isinstance(c.model.parameters.fixed("K"), st.Parameters),
    "Prior": lambda c: c.model.parameters.with_priors({"K": st.Prior(0.1, 0.02, "guess")})["K"].prior,
    "Problem": lambda c: isinstance(st.load_trial(c.trial).problem(), st.Problem),
    "Record": lambda _: st.Record.from_arrays("run", TIME, {"delta": np.zeros(100)}).duration > 9.0,
    "Role": lambda c: st.load_trial(c.trial).runs[0].role in st.Role,
    "Sheet": lambda _: st.Sheet("yaw", source="a paper").states("r"),
    "Ship": lambda _: st.Ship("craft", {"L": 9.8}, "paper", 1.0).particulars["L"] == 9.8,
    "Solution": lambda c: isinstance(c.fit.solution, st.Solution),
    "Study": lambda _: isinstance(st.load(KEPT / "earlier_results" / "study"), st.Study),
    "Trial": lambda c: isinstance(st.load_trial(c.trial), st.Trial),
    "Run": lambda c: isinstance(st.load_trial(c.trial).runs[0], st.Run),
    "Tuning": lambda _: isinstance(st.load(KEPT / "earlier_results" / "tuning"), st.Tuning),
    "benchmark": lambda c: refuses(lambda: st.benchmark("qi2025-135-whole", c.folder, runs=0), "0 runs"),
    "campaign": lambda c: refuses(lambda: st.campaign(c.folder / "none.toml", c.folder / "store"), "cannot be read"),
    "check": lambda c: all(finding.severity != "error" for finding in st.check(c.trial)),
    "compare": lambda c: st.compare(c.fit, c.fit, manoeuvres=()).significant == (),
    "control": lambda _: dir(st.control),
    "correct_trial": lambda c: refuses(lambda: st.correct_trial(c.folder / "none.toml"), "cannot be read"),
    "demo": lambda c: refuses(lambda: st.demo(c.written_record()), "record.csv"),
    "design": lambda c: refuses(lambda: st.design(c.folder / "none.toml"), "cannot be read"),
    "draft_trial": lambda _: "decay" in st.draft_trial(EXAMPLES / "fin_decay" / "decay_1.csv", length=100.0).text,
    "estimators": lambda _: len(st.estimators.available_estimators(5.0)) > 3,
    "export": lambda c: st.export(c.fit, "c99", c.folder / "craft"),
    "follow": lambda c: refuses(lambda: st.follow(c.trial), r"\[follow\]"),
    "identify": lambda c: len(st.identify(c.trial).params) == 8,
    "list_models": lambda _: {"mmg", "nomoto"} <= {summary.name for summary in st.list_models()},
    "load": lambda _: st.load(KEPT / "earlier_results" / "comparison"),
    "load_fit": lambda c: len(c.fit.params) == 11,
    "load_loop": lambda _: st.load_loop(EXAMPLES / "fin_stabiliser.toml").objectives,
    "load_model": lambda _: st.load_model(KEPT / "earlier_files" / "models" / "roll.toml").model.name == "roll",
    "load_trial": lambda c: st.load_trial(c.trial).ship.particulars["L"] == 60.0,
    "manoeuvres": lambda _: dir(st.manoeuvres),
    "models": lambda _: st.models.mmg().states,
    "optimisers": lambda _: st.optimisers.Box(np.zeros(2), np.ones(2)),
    "poster": lambda c: refuses(lambda: st.poster(c.fit, rudder_deg=0.0), "rudder"),
    "predict": lambda c: st.predict(c.model, c.record).rms["psi_deg"] < 0.1,
    "problems": lambda _: st.problems.list_problems(),
    "read_record": lambda c: st.read_record(c.written_record()).duration > 50.0,
    "report": lambda c: st.report(c.fit, c.folder / "report.html").stat().st_size > 10_000,
    "reproduce": lambda _: refuses(lambda: st.reproduce("yu2015"), "did you mean 'yu2014'"),
    "save": lambda c: st.save(c.fit, c.folder / "result").name == "report.html",
    "sea": lambda _: dir(st.sea),
    "simulate": lambda c: float(np.max(np.abs(c.record["psi"]))) > 0.1,
    "survey_log": lambda _: st.survey_log(EXAMPLES / "fin_decay" / "decay_1.csv"),
    "testing": lambda c: st.testing.check_model(c.model) is None,
    "tune": lambda _: refuses(lambda: st.tune(EXAMPLES / "fin_stabiliser.toml", method="guess"), "guess"),
    "verify": lambda c: refuses(lambda: st.verify(EXAMPLES / "fin_stabiliser.toml", {"KP": 1.0}, [c.record]), "gain"),
    "write_record": lambda c: c.written_record().exists(),
}


def test_every_public_name_has_a_case() -> None:
    assert sorted(WORKS) == sorted(st.__all__)


@pytest.mark.parametrize("name", WORKS)
def test_a_public_name_works(name: str, tmp_path: Path) -> None:
    assert WORKS[name](Case(tmp_path))
