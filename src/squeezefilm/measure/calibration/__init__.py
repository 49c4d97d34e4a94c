"""Calibration: a display's uncertain values learned from what was measured of it."""
