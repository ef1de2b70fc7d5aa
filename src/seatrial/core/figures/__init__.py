"""Charts: arrays in, SVG or Matplotlib out.

A figure is a `Chart`: panels with axes, marks in data coordinates and a legend, all of them immutable values. `svg`
writes it for a page, `matplotlib_figure` draws it for a notebook; axes, ticks and legends exist once.
"""
