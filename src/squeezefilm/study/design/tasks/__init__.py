"""The tasks, each described once, in a file of its own."""
