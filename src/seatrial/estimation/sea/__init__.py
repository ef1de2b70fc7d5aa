"""The sea from the motions of the ship in it: spectra and the waves that explain them; sections in regular waves."""

from seatrial._lazy import export_lazily

export_lazily(__name__)
