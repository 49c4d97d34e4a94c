"""The fingertip: what it is made of, its skin in fast and slow motion, its load on a plate."""
