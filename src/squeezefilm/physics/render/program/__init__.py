"""A texture as a program: lowering, the compiled interpreter, the renderer on top of it."""
