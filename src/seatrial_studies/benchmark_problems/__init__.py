"""The papers' problems as benchmark problems: drawn by a seed, with bounds, noise, truth and Cramer-Rao bound."""
