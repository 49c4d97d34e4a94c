"""What the answers of each task say: thresholds, sensitivity, exponents, and how people worked."""
