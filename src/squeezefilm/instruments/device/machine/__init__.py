"""The state machine of a device, as the firmware runs it: limits, heat, what it plays."""
