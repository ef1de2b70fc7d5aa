"""Controllers tuned on a model: front, choice, schedule, nonlinear check, autopilots, bounds."""
