"""Linear feedback loops: blocks, margins, performance in a sea; linear in their gains."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
