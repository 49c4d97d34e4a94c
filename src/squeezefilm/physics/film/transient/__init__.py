"""The film in time: the independent check of the periodic solvers, by another method."""
