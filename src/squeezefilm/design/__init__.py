"""A display on the drawing board: analysed, varied, searched for, made ready to be built."""
