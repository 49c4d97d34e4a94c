"""Textures as values: patterns over place, speed and time, and what composes them."""
