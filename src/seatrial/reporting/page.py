"""The page of a fit: one self-contained HTML file with style and figures; nothing is fetched or fitted."""

from collections.abc import Callable, Iterator

from seatrial.core.results import Fit
from seatrial.core.results.fields import MissingParts
from seatrial.reporting import (
    baselines,
    coefficients_chapter,
    identifiability_chapter,
    key_facts,
    model_chapter,
    prediction_chapter,
    records_chapter,
    runs,
)
from seatrial.reporting import measures as course
from seatrial.reporting import model_chapter as summary
from seatrial.reporting import prediction_chapter as ahead
from seatrial.reporting import section as finding_chapter
from seatrial.reporting.document import chapters_page
from seatrial.reporting.model_chapter import Citations, with_mass_specific_units
from seatrial.reporting.section import Level, Section


def sections(fit: Fit, level: Level = Level.PAGE) -> tuple[Section, ...]:
    """Return the chapters of a fit that have content, in order; level: up to which they are wanted.

    A chapter that cannot be computed is a sentence in its place.
    """
    missing, citations = MissingParts(), Citations()
    chapters = []
    for title, compute in _chapters(fit, citations):
        chapter = missing.computed(f"the chapter '{title}'", compute, None)
        if chapter is None:
            chapter = Section(title.capitalize(), title, sentences=(missing.findings[-1].text,))
        if chapter and chapter.level <= level:
            chapters.append(chapter)
    return tuple(chapters)


def _chapters(fit: Fit, citations: Citations) -> Iterator[tuple[str, Callable[[], Section]]]:
    """Yield the name of each chapter and what computes it."""
    length = fit.ship.particulars.get("L", 0.0)
    is_judged = _is_steered(fit) and not fit.model.has_thrusters
    if fit.reference is not None or not fit.method.gives_intervals:
        yield "published", lambda: _published_section(fit)
    yield "prediction", lambda: prediction_chapter.prediction_section(fit)
    yield "coefficients", lambda: coefficients_chapter.coefficient_section(fit)
    yield "findings", lambda: finding_chapter.finding_section(fit.findings)
    if fit.thruster_craft is not None:
        yield "thrusters", lambda: _thruster_section(fit)
    if fit.roll is not None:
        yield "rolling", lambda: _roll_section(fit)
    if fit.seakeeping is not None:
        yield "waves", lambda: _seakeeping_section(fit, length)
    yield "identifiability", lambda: identifiability_chapter.identifiability_section(fit)
    yield "course", lambda: course.course_section(fit)
    yield "models", lambda: identifiability_chapter.model_section(fit.candidate_models)
    yield "baselines", lambda: baselines.baseline_section(fit)
    yield "terms", lambda: baselines.term_section(fit)
    yield "training", lambda: prediction_chapter.training_section(fit)
    yield "records", lambda: records_chapter.record_section(fit)
    yield "offsets", lambda: records_chapter.offset_section(fit)
    yield "residuals", lambda: records_chapter.residual_section(fit)
    yield "ahead", lambda: ahead.k_step_section(fit)
    yield "frequency", lambda: ahead.frequency_section(fit)
    if is_judged:  # they are for ships of 100 m and more
        yield "standards", lambda: runs.standard_section(runs.drawn_predictions(fit.predictions), fit, length)
    yield "model", lambda: model_chapter.equation_section(fit.model, citations)
    yield "fixed", lambda: coefficients_chapter.assumed_section(fit, citations)
    yield "method", lambda: model_chapter.method_section(fit, citations)


# Chapters that few fits have: their modules are loaded for these alone.


def _published_section(fit: Fit) -> Section:
    from seatrial.reporting.published_chapter import published_section

    return published_section(fit)


def _thruster_section(fit: Fit) -> Section:
    from seatrial.reporting.thruster_chapter import thruster_section

    return thruster_section(fit.thruster_craft)


def _roll_section(fit: Fit) -> Section:
    from seatrial.reporting.seakeeping_chapter import roll_section

    return roll_section(fit.roll, fit.ship.scale)


def _seakeeping_section(fit: Fit, length: float) -> Section:
    from seatrial.reporting.seakeeping_chapter import seakeeping_section

    return seakeeping_section(fit.seakeeping, length)


def _is_steered(fit: Fit) -> bool:
    return fit.model.has_heading or fit.model.has_rudder


def html(fit: Fit) -> str:
    """Return the page as text; chapters without content are left out."""
    fit = with_mass_specific_units(fit)
    kind = "Manoeuvring model" if _is_steered(fit) else "Motion model"
    length = 0.0 if fit.model.has_thrusters else fit.ship.particulars.get("L", 0.0)
    return chapters_page(
        "Identification report",
        f"{kind} of {fit.ship.name}",
        key_facts.first_screen(fit, length),
        sections(fit),
        title=f"{fit.ship.name}: {fit.model.name} model from trials",
        question=fit.question,
        about=summary.facts(fit),
    )
