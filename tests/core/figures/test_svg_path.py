"""Paths are short and no point of a line is farther from what is drawn than a reader can see."""

import re

import numpy as np

from seatrial.core.figures.marks import Array
from seatrial.core.figures.svg_path import UNSEEN, path_data, visible_points


def positions(data: str) -> Array:
    """The corners of a path of one stretch."""
    start, _, moves = data.partition("l")
    numbers = [float(n) for n in re.findall(r"-?\d*\.?\d+", moves)]
    first = [float(n) for n in re.findall(r"-?\d*\.?\d+", start)]
    return np.cumsum(np.array([first, *np.reshape(numbers, (-1, 2)).tolist()]), axis=0)


def distance_to_line(corners: Array, x: float, y: float) -> float:
    """From a point to the nearest part of a line."""
    a, d = corners[:-1], np.diff(corners, axis=0)
    share = np.clip(((x - a[:, 0]) * d[:, 0] + (y - a[:, 1]) * d[:, 1]) / (d**2).sum(axis=1), 0.0, 1.0)
    return float(np.hypot(a[:, 0] + share * d[:, 0] - x, a[:, 1] + share * d[:, 1] - y).min())


def test_no_point_is_farther_from_the_line_than_can_be_seen() -> None:
    t = np.linspace(0.0, 20.0, 400)
    px, py = 40.0 * t, 200.0 + 80.0 * np.sin(t)
    data = path_data(px, py)
    corners = positions(data)
    # what is left out, and rounding to tenths of both ends of a part
    assert max(distance_to_line(corners, x, y) for x, y in zip(px, py, strict=True)) < UNSEEN + 0.1
    assert len(corners) < 150 and len(data) < 1200


def test_a_straight_line_is_two_points_and_noise_stays() -> None:
    t = np.linspace(0.0, 100.0, 50)
    assert visible_points(t, 2.0 * t).sum() == 2
    assert visible_points(t, np.where(np.arange(50) % 2, 1.0, -1.0)).all()
    assert visible_points(np.array([0.0, 50.0, 0.0]), np.zeros(3)).all()


def test_numbers_are_short_and_gaps_stay_gaps() -> None:
    x = np.array([1.0, 2.5, 2.0, np.nan, 7.0, 7.0])
    assert path_data(x, np.array([0.0, -0.5, 3.0, 1.0, 4.0, 9.25])) == "M1 0l1.5-.5-.5 3.5M7 4l0 5.2"
    assert path_data(np.array([np.nan]), np.array([1.0])) == ""
