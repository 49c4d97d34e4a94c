"""Questions about gas films: one film, a map of films, models side by side."""
