"""Analyses of each task's answers: thresholds, sensitivity, exponents, and how people worked."""
