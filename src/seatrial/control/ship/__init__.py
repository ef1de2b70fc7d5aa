"""The ship behind a loop: an identified model, its trim, its plant, and draws of its parameters."""
