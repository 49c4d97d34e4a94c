"""What `reproduce` shows: the page of claims, the prototype, the paper's figures redrawn."""
