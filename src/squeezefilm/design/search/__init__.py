"""Design search: requirements in, plates that meet them out."""
