"""Equivalent circuits of an impedance sweep."""
