"""Output of `play` about a session: page, figures, the terminal while it plays."""
