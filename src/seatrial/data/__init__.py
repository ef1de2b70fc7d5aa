"""Records and trial files in, result folders out."""
