"""What `friction` shows: its figures and its terminal output."""
