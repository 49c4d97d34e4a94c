"""Contact from film pressure to friction: finger, load sharing and the paper's friction model."""
