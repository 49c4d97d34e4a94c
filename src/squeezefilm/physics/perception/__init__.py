"""Perception of a person: stimuli, the senses of the fingertip, percepts, and how people differ."""
