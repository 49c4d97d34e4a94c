"""What the surface should feel like, and what of it gets through a slow resonator.

`texture` (patterns as values), `stroke` and `minimum_jerk` (how the finger moves), `sensor` and
`motion` (where it is, from late and noisy samples), `envelope` (the resonator's slow amplitude),
`compensation` and `compensated_swing` (its inverse within the voltage), `carrier` (the vibration
itself), `trace` and `rendered_stroke` (friction under a moving finger), `fidelity` and
`fidelity_report` (what of the pattern survives). Pure: no clock, no I/O, and no physics; friction
enters as a callable.
"""
