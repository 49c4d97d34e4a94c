"""Studies as the lab runs them: files, sittings, their devices, long work."""
