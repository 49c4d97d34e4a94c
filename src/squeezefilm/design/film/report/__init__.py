"""Output of `film`: a map over squeeze number and excursion."""
