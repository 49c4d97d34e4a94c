"""Sweeps: many points asked the same questions, and answered by several processes."""
