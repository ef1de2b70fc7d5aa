"""The loop file: what is controlled, by what, in which disturbances; TOML to a `TuningTask`."""
