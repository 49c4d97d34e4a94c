"""The worked case: the paper's plate, whose prototype is not what its model predicts."""
