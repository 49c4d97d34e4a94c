"""The skin-stretch array: bending actuators that pull the skin of a fingertip sideways."""
