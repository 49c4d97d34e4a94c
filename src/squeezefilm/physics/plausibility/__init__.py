"""Whether a description can be true: checked against what is built, before anything is solved."""
