"""Textures and motions in files: TOML, pictures, trajectories, MPEG haptics."""
