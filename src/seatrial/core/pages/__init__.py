"""The shell of every page: head, style for screen, dark and paper, and a policy of what may take effect."""
