"""A texture as a program: lowering, the compiled tick, the renderer on top of it."""
