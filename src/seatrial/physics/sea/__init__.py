"""Sea states, spectra, realisations, encounter frequencies and the forces of waves on a ship."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
