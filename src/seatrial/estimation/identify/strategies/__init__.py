"""One strategy of `identify` for each situation: from an identification to a fit."""
