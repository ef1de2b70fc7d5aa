"""The workspace: a trial file in the browser; every act is an edit of it, computed by the functions of `seatrial`."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
