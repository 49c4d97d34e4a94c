"""What the plate loses warms it: temperature, drift, what both cost; and where a ceramic ends."""
