"""The vibrating body: layout, laminate, beams and their response. Knows nothing of the film."""
