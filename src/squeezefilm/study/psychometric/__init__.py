"""Psychometric functions and scales: fits, intervals, d′, Stevens' power law."""
