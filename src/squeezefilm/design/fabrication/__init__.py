"""What a workshop needs to know of a display, in numbers: electrodes, bodies as triangles, bill."""
