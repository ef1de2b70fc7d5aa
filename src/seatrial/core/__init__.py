"""Named values, equations, results, and how they are drawn and written."""
