"""Real interfaces: what is said on the wire, what a device may do, and how a host talks to it.

`ports` holds the seams, one method wide, and a recording as a sensor. `wire`: bytes, frames and
messages, the limits that every device obeys, the host's side of the line. `machine`: the device
itself, pure, time is passed in; the state machine that `firmware/` writes in C, with what it plays,
its heat and its readings. Above them `host` (commands in SI), `device_clock` and `serial_ports` (a
drive on a device). Imports no physics.
"""
