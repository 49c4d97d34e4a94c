"""Output of `reproduce`: the page of claims, the prototype, the paper's figures redrawn."""
