"""Sea state to spectrum to realisation; encounter frequencies; what a ship in it feels. Knows no model."""
