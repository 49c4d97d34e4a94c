"""Designs of studies: its design, its trials and their order, what it takes."""
