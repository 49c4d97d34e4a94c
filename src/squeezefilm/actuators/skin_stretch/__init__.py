"""The skin-stretch array: bending actuators on a cradle that pull the skin of a fingertip sideways."""
