"""seatrial: sea-trial records into ship motion models you can defend."""

__version__ = "0.1.0"
