"""Control loops of a vibrating plate as pure step functions, in the integers of the firmware."""
