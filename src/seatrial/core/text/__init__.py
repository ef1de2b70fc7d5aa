"""Numbers and words for people: reports, terminal and live view share them."""
