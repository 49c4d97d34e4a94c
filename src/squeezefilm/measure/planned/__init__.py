"""What is to be made and measured of a display, with what is expected of it."""
