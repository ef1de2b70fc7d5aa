"""Models written once as named bindings; code, Jacobians and LaTeX are generated from them."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
