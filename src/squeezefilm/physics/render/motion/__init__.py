"""Motion of a finger, what a sensor sees of it, and where it is estimated to be."""
