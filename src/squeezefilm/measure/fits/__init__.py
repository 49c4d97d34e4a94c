"""Fits: numbers with intervals out of recordings, and whether the fitted model is adequate."""
