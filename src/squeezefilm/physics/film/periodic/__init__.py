"""The periodic film on a line, solved: strip, disc, any profile of the gap, one or thousands."""
