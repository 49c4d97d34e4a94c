"""Analysis of an actuator's description: of a motor, of a skin-stretch array."""
