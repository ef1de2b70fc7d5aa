"""Figures as inline SVG, one file for each family."""
