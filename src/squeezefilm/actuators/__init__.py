"""Other products of plates and bent ceramics: a standing-wave motor, a skin-stretch array."""
