"""Published studies repeated, a package each; seatrial finds them through the entry-point group `seatrial.studies`."""
