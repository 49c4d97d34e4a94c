"""The loop in real time: one compiled tick, its clock, its rings and its own process."""
