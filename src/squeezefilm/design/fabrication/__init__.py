"""Numbers of a display for its workshop: electrodes, bodies as triangles, bill."""
