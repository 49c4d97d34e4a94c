"""Recordings: files of a bench with a description beside them, read into arrays with units."""
