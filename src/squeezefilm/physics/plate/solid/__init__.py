"""Plates as piezoelectric solids in three dimensions: modes, errors, response, admittance."""
