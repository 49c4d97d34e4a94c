"""What `play` shows of a session: page, figures, the terminal while it plays."""
