"""Heat that the plate loses: temperature, drift, what both cost; and where a ceramic ends."""
