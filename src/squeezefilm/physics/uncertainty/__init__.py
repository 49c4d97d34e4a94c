"""Uncertainty of a display, drawn: its parameters, and intervals of a prediction."""
