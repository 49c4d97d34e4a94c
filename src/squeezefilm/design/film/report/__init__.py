"""What `film` shows: a map over squeeze number and excursion."""
