"""Files that other programs read and write: sound, tables, pictures, trajectories, MPEG haptics."""
