"""What a study asks: its design, its trials and their order, what it takes."""
