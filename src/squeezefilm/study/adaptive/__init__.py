"""Adaptive choice of the next stimulus: staircases, Bayesian placement, series of a design."""
