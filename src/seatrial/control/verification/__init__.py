"""A controller after its trial at sea: predicted against achieved, and what in the model was wrong."""
