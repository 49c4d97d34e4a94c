"""What `render` shows: page, figures, tables, and the gallery of textures."""
