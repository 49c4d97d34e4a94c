"""The real-time loop from sensor to drive, and its append-only record.

The loop: `plan` (what it shall do), `tick` (one compiled step, no Python), `pacing` (when it is
made), `clock`, `atomics`, `ring` and `shared` (memory that two processes share), `loop` and
`worker` (its own process), `simulated` (the same tick on a simulated clock), `lateness`, `rows`
(what a session writes down). `tile` samples a texture for a device that looks it up itself.
"""
