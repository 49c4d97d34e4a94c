"""Figures of a motor: its causal ordering graph, its thrust and its foot."""
