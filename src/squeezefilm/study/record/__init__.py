"""A study's file: one SQLite database, exports from it, merging, deletion."""
