"""High-order elements on boxes: nodes, slices, their factorisation, and the eigensolver on them."""
