"""Output of `render`: page, figures, tables."""
