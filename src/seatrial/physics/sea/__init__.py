"""Sea states, spectra, realisations, encounter frequencies and the forces of waves on a ship."""
