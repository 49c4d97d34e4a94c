"""Rendering: what the surface should feel like, how it is played, and what a resonator passes.

`texture`: textures as values, in place, speed and time, and how they compose; `interpret` runs
their instructions (`opcodes`). `program`: the flat array that a texture lowers to, the compiled
tick, its twin for a page in `static/renderer.js`, and the renderer on top. `motion`: how the
finger moves, and where it is, from late and noisy samples. `resonator`: its envelope, the
compensation of its slowness within the voltage, the carrier. `fidelity`: friction under a
moving finger, and what of a pattern survives. Pure: no clock, no I/O, and no physics; friction
enters as a callable or a table.
"""
