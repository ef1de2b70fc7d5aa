"""The page of a fit: one self-contained HTML file with style and figures; nothing is fetched or fitted."""

import math
from collections.abc import Callable, Iterator, Mapping

from markupsafe import Markup

from seatrial.core.figures.heat_map import heat_map
from seatrial.core.figures.run import NARROW
from seatrial.core.figures.svg_text import svg
from seatrial.core.results import Fit
from seatrial.core.results.fields import MissingParts
from seatrial.core.results.fit_charts import coefficients_chart
from seatrial.core.text.words import common_prefix
from seatrial.core.values.arrays import correlation_matrix
from seatrial.reporting import (
    ahead,
    baselines,
    identifiability_chapter,
    key_facts,
    published_chapter,
    resimulation,
    roll_chapter,
    runs,
    seakeeping_chapter,
    summary,
    tables,
    thruster_chapter,
)
from seatrial.reporting.citations import Citations
from seatrial.reporting.correlations import correlation_text
from seatrial.reporting.document import page_text
from seatrial.reporting.figures.record_charts import track_overview
from seatrial.reporting.figures.residual_charts import residual_series, whiteness_chart
from seatrial.reporting.figures.search_charts import attempts_chart
from seatrial.reporting.grades import GRADE_NOTE
from seatrial.reporting.mass_specific import with_mass_specific_units
from seatrial.reporting.wind import wind_sentence
from seatrial.reporting.windows import WINDOW_NOTE, baseline_sentence, shortest_judged

TITLES = {
    "published": "The published method and the package’s own estimate",
    "prediction": "Prediction of held-out runs",
    "coefficients": "Coefficients",
    "identifiability": "Identifiability: what the records determine",
    "thrusters": "The craft: speed, turn, stop, thrust, matrices",
    "rolling": "Roll: period, damping, metacentric height",
    "waves": "Motions in waves",
    "findings": "Findings",
    "records": "Records",
    "training": "Fit of the training runs",
    "ahead": "Prediction some samples ahead",
    "frequency": "Frequency response: records and model",
    "baselines": "Other estimators on the same records",
    "residuals": "Residuals",
    "offsets": "Offsets",
    "standards": "IMO standards",
    "model": "Equations of the model",
    "fixed": "Fixed values and priors",
    "method": "Method and provenance",
}


def html(fit: Fit) -> str:
    """Return the page as text; sections without content are left out."""
    fit, citations = with_mass_specific_units(fit), Citations()
    length = fit.ship.length if "L" in fit.ship.particulars else 0.0
    has_thrusters = fit.model.has_thrusters
    is_steered = fit.model.has_heading or fit.model.has_rudder
    shown = runs.drawn_predictions(fit.predictions)
    drawn_names = {p.record for p in shown}
    parts = MissingParts()
    chapters: dict[str, object] = {
        name: parts.computed(f"the chapter '{TITLES[title]}'", compute, None)
        for name, title, compute in _chapters(fit, length)
    }
    sections: dict[str, object] = {
        **chapters,
        "findings": tables.finding_groups((*fit.findings, *parts.findings)),
        "noise": tables.noise(fit.channel_noise),
        "offsets": tables.offsets(fit.offsets),
        # they are for ships of 100 m and more
        "standards": runs.standards(shown, fit, length) if is_steered and not has_thrusters
        else {"rows": [], "notes": []},
        "fixed": tables.fixed_parameters(fit.coefficients, citations),
        "priors": tables.priors(fit.coefficients, fit.model, citations),
        "coefficients": tables.coefficients(fit.coefficients),
    }  # fmt: skip
    context: dict[str, object] = {
        "fit": fit,
        "titles": _titles(fit, sections),
        "is_steered": is_steered,
        "screen": key_facts.first_screen(fit, 0.0 if has_thrusters else length),
        "facts": summary.facts(fit),
        "coefficient_sentences": summary.coefficient_sentences(fit),
        "residual_sentence": summary.residual_sentence(fit),
        "convergence_sentence": summary.convergence_sentence(fit),
        "search_status": summary.search_status(fit),
        "offset_sentences": summary.offset_sentences(fit),
        "better_baselines": baseline_sentence(fit.validation, runs.ERROR_LABELS, shortest_judged(fit)),
        "grade_note": GRADE_NOTE,
        "reading_note": runs.reading_note(fit.predictions),
        "window_note": WINDOW_NOTE if any(p.windows for p in fit.predictions) else "",
        "scores": runs.score_table(fit.predictions, 0.0 if has_thrusters else length),
        "records": tables.records(fit),
        "wind": wind_sentence(fit.records),
        "without": _prefix_note(fit),
        "tracks": Markup(svg(track_overview([r for r in fit.records if r.name in drawn_names] or fit.records, length))),
        "resimulation": resimulation.resimulation(fit),
        "runs": runs.run_sections(shown, length, fit.model.input_names),
        "hidden_runs": runs.hidden_runs_sentence(fit.predictions),
        "equations": tables.equations(fit.model, citations),
        "sign_conventions": tables.sign_conventions(fit.model),
        "has_intervals": any(c.lower is not None for c in fit.coefficients if not c.fixed),
        "has_truth": any(c.truth is not None for c in fit.coefficients if not c.fixed),
        "has_meaning": any(c.meaning for c in fit.coefficients if not c.fixed),
        "has_prior": any(c.prior_mean is not None for c in fit.coefficients if not c.fixed),
        "forest": Markup(svg(coefficients_chart(fit.coefficients))),
        "narrow_forest": Markup(svg(coefficients_chart(fit.coefficients, NARROW))),
        "correlation": Markup(_correlation_figure(fit)),
        "correlated": correlation_text(
            fit.model.parameters.free_names,
            fit.covariance,
            math.inf if fit.interval_basis is None else fit.interval_basis.degrees_of_freedom,
        ),
        "residual_series": residual_series(fit.residuals),
        "whiteness": Markup(svg(whiteness_chart(fit.residuals))),
        "ship_source": citations.mark(fit.ship.source),
        "settings": tables.settings(fit.method),
        "attempts": Markup(svg(attempts_chart(fit.search_attempts))),
        "citations": citations,
    }
    return page_text("report.html", sections | context)


def _chapters(fit: Fit, length: float) -> Iterator[tuple[str, str, Callable[[], object]]]:
    """Yield name, key of the title and contents of each chapter that a report may be without."""
    yield "published", "published", lambda: published_chapter.published_chapter(fit)
    yield "identifiability", "identifiability", lambda: identifiability_chapter.identifiability_chapter(fit)
    yield "craft", "thrusters", lambda: thruster_chapter.thruster_chapter(fit.thruster_craft)
    roll, sea = fit.roll, fit.seakeeping
    yield "rolling", "rolling", lambda: roll and {
        "tables": roll_chapter.tables(roll, fit.ship.scale), "figures": roll_chapter.figures(roll)
    }  # fmt: skip
    yield "waves", "waves", lambda: sea and {
        "tables": seakeeping_chapter.tables(sea, length), "figures": seakeeping_chapter.figures(sea)
    }  # fmt: skip
    yield "ahead", "ahead", lambda: ahead.k_step_chapter(fit)
    yield "frequency", "frequency", lambda: ahead.frequency_chapter(fit)
    yield "baselines", "baselines", lambda: baselines.baseline_chapter(fit)


def _titles(fit: Fit, sections: Mapping[str, object]) -> dict[str, str]:
    """The sections that have content, in order."""
    standards, offsets = sections["standards"], sections["offsets"]
    has_content = {
        **{key: bool(sections[key]) for key in ("published", "identifiability", "rolling", "waves", "findings", "ahead",
                                                "frequency", "baselines", "coefficients")},
        "thrusters": bool(sections["craft"]),
        "prediction": bool(fit.validation),
        "training": any(p.role == "training" for p in fit.predictions),
        "residuals": bool(fit.residuals or fit.channel_noise),
        "offsets": isinstance(offsets, dict) and bool(offsets["rows"]),
        "standards": isinstance(standards, dict) and bool(standards["rows"]),
        "fixed": bool(sections["fixed"] or sections["priors"]),
    }  # fmt: skip
    return {key: title for key, title in TITLES.items() if has_content.get(key, True)}


def _prefix_note(fit: Fit) -> str:
    prefix = common_prefix([r.name for r in fit.records])
    return f" Names without their common beginning, {prefix}" if prefix else ""


def _correlation_figure(fit: Fit) -> str:
    """The lower triangle of the correlations; empty for fewer than two free coefficients."""
    names = fit.model.parameters.free_names
    if len(names) < 2 or fit.covariance.shape != (len(names), len(names)):
        return ""
    below = correlation_matrix(fit.covariance)[1:, :-1]
    return svg(heat_map("correlations of the free coefficients", names[1:], names[:-1], below, is_lower=True))
