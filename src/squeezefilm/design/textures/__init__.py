"""Results of a display with textures: what is left of gratings, and their pages."""
