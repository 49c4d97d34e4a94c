"""Who carries the finger: gas film and asperities in balance, and the models compared with it."""
