"""Answers about a display as a whole: analysis, the paper's design procedure, its claims."""
