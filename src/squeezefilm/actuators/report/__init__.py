"""Reports of actuators: `squeezefilm analyze` of a motor or of a skin-stretch array."""
