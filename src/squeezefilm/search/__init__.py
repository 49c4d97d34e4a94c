"""Sweeps: many points asked the same questions, and answered by several processes; and, in
`search.design`, design searches: requirements in, plates that meet them out."""
