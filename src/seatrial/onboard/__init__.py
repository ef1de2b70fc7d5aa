"""On board: samples as they come, an estimate as it grows, a table and a page that show it."""
