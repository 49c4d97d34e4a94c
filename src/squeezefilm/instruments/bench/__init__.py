"""Bench for a device or its twin: set-up, play, device check, what a session played."""
