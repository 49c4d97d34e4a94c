"""The periodic film in the plane, solved: rectangle, disc, ellipse, with waves and ridges."""
