"""Reports on what a bench measured: what was read, what was fitted to it."""
