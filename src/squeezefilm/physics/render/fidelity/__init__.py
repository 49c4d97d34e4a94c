"""Fidelity of what reaches the finger: whole strokes, and numbers that compare them."""
