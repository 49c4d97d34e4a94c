"""What the surface should feel like, how it is played, and what gets through a slow resonator.

Textures as values: `coordinate`, `pattern`, `pattern_shapes`, `pattern_noise`, `pattern_image`,
`pattern_gates` (dimensionless), `levels` and `texture` (in a quantity), `composition` (how they
compose). Played: `inverse` (friction to amplitude), `wave` (the standing wave's ripple),
`opcodes`, `layout`, `program` (the flat array a texture lowers to), `interpreter` (the compiled
tick), `renderer` (it with its state), and `static/renderer.js`, the same for a page.
Felt: `stroke` (how the finger moves), `envelope` (the resonator's slow amplitude), `trace`
(friction under a moving finger) and `fidelity` (which pattern survives at which speed). Pure: no
clock, no I/O, and no physics; friction enters as a callable or a table.
"""
