"""What a display makes of textures: what is left of gratings, and their pages."""
