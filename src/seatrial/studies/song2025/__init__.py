"""Song et al. 2025: support vector regression for a waterjet craft, repeated as published, audited, and answered."""
