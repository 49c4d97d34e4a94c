"""Output of a design search: on a terminal, as figures, as a page, as files of displays."""
