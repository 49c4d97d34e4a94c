"""Recordings of a vibrometer: modes, shapes, losses, softening."""
