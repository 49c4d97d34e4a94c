"""Checks that a description can be true, against what is built, before anything is solved."""
