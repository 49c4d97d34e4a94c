"""Real interfaces: what is said on the wire, what a device may do, and how a host talks to it.

`wire`: bytes, frames and messages, and the host's side of the line. `machine`: the device itself,
pure, time is passed in; the state machine that `firmware/` writes in C, with its limits, what it
plays, its heat and its readings. Above them `host` (commands in SI) and `ports`, the
seams of a session: a sensor and a drive, each one method wide. Imports no physics.
"""
