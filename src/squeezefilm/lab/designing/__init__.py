"""Display on the pages: its form, its numbers, its program for the browser."""
