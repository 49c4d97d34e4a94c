"""Sharing of the load: gas film and asperities in balance, and the models compared with it."""
