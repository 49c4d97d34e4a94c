"""What a design search found: on a terminal, as figures, as a page, as files of displays."""
