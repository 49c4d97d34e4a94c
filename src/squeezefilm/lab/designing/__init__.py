"""What the pages show of a display: its form, its numbers, its program for the browser."""
