"""Playing a texture on a device: the player, in real time and on a simulated clock."""
