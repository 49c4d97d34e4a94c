"""What is said on the wire, what a device does with it, and that C and Python do the same."""
