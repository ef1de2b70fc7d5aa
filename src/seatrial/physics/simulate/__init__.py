"""From a model and a record to a record: inputs replayed, manoeuvres steered, loops closed."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
