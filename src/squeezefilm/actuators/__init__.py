"""What plates and bent ceramics also make: a standing-wave motor, a skin-stretch array."""
