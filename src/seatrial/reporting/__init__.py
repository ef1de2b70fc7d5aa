"""Fits, designs, tunings and studies as self-contained HTML pages: a result in, text out; computes nothing."""
