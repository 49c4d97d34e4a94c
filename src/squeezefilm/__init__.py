"""squeezefilm: tactile displays that change the friction of a surface by ultrasonic vibration."""

__version__ = "0.1.0"
