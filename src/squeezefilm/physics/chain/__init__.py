"""Chain from volts to friction and from texture to friction along a stroke: what joins plate, film,
contact and rendering."""
