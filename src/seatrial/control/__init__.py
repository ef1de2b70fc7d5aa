"""Controllers tuned on a model: objectives, front, choice, schedule, simulation in a seaway, bounds."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
