"""A display as a workshop and a bench get it: drawing, tables, files."""
