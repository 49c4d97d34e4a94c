"""Output of a film, of a friction and of a rendered texture: terminal, figures, pages."""
