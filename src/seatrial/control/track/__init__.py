"""Track keeping: line of sight around a heading loop, tuned, tried in weather and at a corner."""
