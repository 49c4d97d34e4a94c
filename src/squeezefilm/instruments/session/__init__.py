"""The real-time loop from sensor to drive, and its append-only record.

`loop`: one compiled tick without Python, what it shall do, when it is made, its memory and its
own process. `record`: what a session writes down, and
its export. `play`: the player that joins loop, link and record, in real time or on any other
clock, and the texture as a tile for a device that looks it up itself.
"""
