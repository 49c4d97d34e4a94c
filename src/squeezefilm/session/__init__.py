"""The real-time loop from sensor to drive, and its append-only record."""
