"""Recordings of a friction bench: strokes, and friction against amplitude."""
