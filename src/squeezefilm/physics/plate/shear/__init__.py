"""First-order shear plates: the screening theory between the beam and the solid."""
