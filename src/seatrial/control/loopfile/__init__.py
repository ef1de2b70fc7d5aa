"""The loop file: what is controlled, by what, against what; TOML to a `TuningTask`."""
