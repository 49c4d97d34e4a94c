"""Results that are dear to compute, on disk from one process to the next: found again only by the
same code, asked the same question, and read as numbers and never as code."""
