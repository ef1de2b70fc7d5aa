"""Figures as inline SVG, one file for each family over one small plotter."""
