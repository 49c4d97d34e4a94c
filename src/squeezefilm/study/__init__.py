"""Psychophysics: designs, adaptive methods, simulated observers, running, statistics, exchange."""
