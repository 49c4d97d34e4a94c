"""What a vibrometer recorded: modes, shapes, losses, softening."""
