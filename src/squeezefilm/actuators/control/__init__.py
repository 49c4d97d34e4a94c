"""Pure step functions of controllers: state in, command out; no clock, no files, no physics."""
