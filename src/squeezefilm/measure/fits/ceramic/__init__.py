"""Constants of a bare ceramic, bar or disc, from its impedance."""
