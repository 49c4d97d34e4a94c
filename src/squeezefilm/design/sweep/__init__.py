"""Sweeps: many points asked the same questions, and answered by several processes; and, in
`design.search`, design searches: requirements in, plates that meet them out."""
