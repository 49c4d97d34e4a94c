"""What the surface should feel like, and what of it gets through a slow resonator.

`texture` (patterns as values), `stroke` (how the finger moves), `envelope` (the resonator's slow
amplitude), `trace` (friction under a moving finger) and `fidelity` (which pattern survives at
which speed). Pure: no clock, no I/O, and no physics; friction enters as a callable.
"""
