"""KVLCC2 from zigzags: Alexandersson, Mao & Ringsberg 2022 repeated on the records they used."""

from seatrial_studies.alexandersson2022.study import study

__all__ = ["study"]
