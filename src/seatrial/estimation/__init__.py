"""From records and a model to coefficients with intervals, predictions and manoeuvres to run next."""
