"""Output of `friction`: its figures and its terminal output."""
