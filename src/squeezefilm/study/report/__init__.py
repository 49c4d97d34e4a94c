"""Reports of studies, of people and of simulated ones: pages, figures, the terminal."""
