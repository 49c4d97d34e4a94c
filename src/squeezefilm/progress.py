"""What long work tells of itself while it runs, as it is handed down to what works."""

from __future__ import annotations

from collections.abc import Callable

SayProgress = Callable[[str], None]
"""Told in words what is being done."""

CountProgress = Callable[[int, int], None]
"""Told how many of how many are done."""

ShareProgress = Callable[[str, float], None]
"""Told in words what is being done, and which share of it is done, from 0 to 1."""
