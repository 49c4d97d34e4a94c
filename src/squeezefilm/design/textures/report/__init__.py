"""What `render` shows: page, figures, tables."""
