"""Discs and rings as piezoelectric solids, one Fourier harmonic at a time."""
