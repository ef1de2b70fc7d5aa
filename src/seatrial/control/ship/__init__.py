"""The ship behind a loop: an identified model, its trim, its plant, and the ships that its fit allows."""
