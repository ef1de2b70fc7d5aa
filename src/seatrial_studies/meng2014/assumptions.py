"""What the paper does not print, or the text at hand has lost, and what stands in its place here."""

from seatrial.core.results import Table
from seatrial_studies.meng2014.reproduction import ITERATIONS, RUNS, CloudSwarmReproduction

_ROWS = (
    ("table 1: coefficients and errors", "lost", "nothing; errors of our own searches"),
    ("ship and coefficients", "not printed", "Qi et al. 2025; at 0 and 45° those of 90°; b53 negative"),
    ("box of the searches", "not printed", "±50 % with the truth off centre; ±10 % about it beside"),
    ("sea state 3", "no height printed", "0.88 m, ITTC spectrum, 30 equal intervals, random phases"),
    ("forces of the waves", "not printed", "box-shaped hull in closed form, Jensen, Mansour & Olsen 2004"),
    ("fin", "±10°, pseudo-random", "±10° held for 1 s; 6 m², lift slope 3/rad, 25 m aft"),
    ("measurement noise", "white, no number", "1 cm and 0.02°"),
    ("record", "number of samples not printed", "200 s, a sample every 0.5 s, from rest, force held"),
    ("fitness, eq. (7)", "lost", "root mean square of heave in m and pitch in degrees"),
    ("inertia weight in eq. (4)", "not printed", "multiplies the velocity"),
    ("law of the weight, eq. (6)", "lost but for its constants", "normal cloud in the form of Wei et al. 2009"),
    ("mutation", "probability 0.2; law lost", "particles with ratio below B become drops round the best"),
    ("its spread", "lost", "En from 0.1 of the range to 0, He = En / 10"),
    ("velocity limit", "not printed", "0.2 of the range"),
)


def assumption_table(reproduction: CloudSwarmReproduction) -> Table:
    """One row for each; the note says what a quick run leaves out."""
    runs = len(next(iter(reproduction.seas.values())))
    note = f"{runs} runs of {reproduction.iterations} iterations at each heading, each in a sea of its own."
    if (runs, reproduction.iterations) != (RUNS, ITERATIONS):
        note += f" This is the quick version: the whole one has {RUNS} runs of {ITERATIONS}."
    return Table("Assumed", ("what", "print", "here"), _ROWS, note)
