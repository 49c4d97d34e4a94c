"""Closed forms of the gas film: the limits of small vibration and of large squeeze number."""
