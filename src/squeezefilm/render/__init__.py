"""What the surface should feel like, how it is played, and what gets through a slow resonator.

Textures as values: `coordinate`, `pattern`, `pattern_shapes`, `pattern_noise`, `pattern_image`,
`pattern_gates` (dimensionless), `levels` and `texture` (in a quantity), `composition` (how they
compose). Played: `inverse` (friction to amplitude), `wave` (the standing wave's ripple),
`opcodes`, `layout`, `program` (the flat array a texture lowers to), `interpreter` (the compiled
tick), `renderer` (it with its state), and `static/renderer.js`, the same for a page.
Felt: `stroke`, `minimum_jerk` and `finger_path` (how the finger moves), `sensor` and `motion`
(where it is, from late and noisy samples), `envelope` (the resonator's slow amplitude),
`compensation` and `compensated_swing` (its inverse within the voltage), `carrier` (the vibration
itself), `trace` and `rendered_stroke` (friction under a moving finger), `fidelity` and
`fidelity_report` (what of the pattern survives). Pure: no clock, no I/O, and no physics; friction
enters as a callable or a table.
"""
