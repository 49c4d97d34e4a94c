"""Measurements: recordings read and checked, fitted, and turned into a calibrated display.

`recordings/` reads files, `fits/` makes numbers with intervals of them, `calibration/` learns a
display's uncertain values from these numbers, predicts blind and scores.
"""
