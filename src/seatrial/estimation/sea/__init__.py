"""The sea from the motions of the ship in it: spectra of stretches, and the wave spectrum that explains them."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
