"""Real interfaces: what is said on the wire, what a device may do, and how a host talks to it.

`ports` (the seams, one method wide), `safety` (limits and who stops by itself).
The wire: `cobs` and `frames` (bytes), `messages` (what a frame says).
The device, pure, time is passed in: `machine` (the state machine that `firmware/` writes in C),
`states`, `device_limits`, `playing` (envelopes), `tile` (amplitude over position), `loads` (heat
and duty), `reports` (readings).
The host: `streams` (a serial port), `link` (frames to answers), `device_clock`, `host` (commands in
SI), `serial_ports` (drive, sensor and pickup on a device); sensors without a device: `replay` (a
recording) and `pointer` (events from outside). Imports no physics.
"""
