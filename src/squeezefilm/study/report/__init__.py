"""What studies show, of people and of simulated ones: pages, figures, the terminal."""
