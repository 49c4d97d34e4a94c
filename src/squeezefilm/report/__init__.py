"""Figures, the HTML report and what the terminal shows of a result; nothing computes physics."""
