"""Controllers tuned on a model: objectives, front, choice, schedule, simulation in a seaway, bounds."""
