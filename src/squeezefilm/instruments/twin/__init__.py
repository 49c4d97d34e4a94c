"""A simulated device and hand, behind the wire protocol.

Plate, amplifier, film and friction, sensor and pickup, on a virtual or a real clock.
"""
