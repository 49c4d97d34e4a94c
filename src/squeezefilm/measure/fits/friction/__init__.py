"""What a friction bench recorded: strokes, and friction against amplitude."""
