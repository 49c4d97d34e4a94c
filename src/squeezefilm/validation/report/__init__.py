"""Output of `reproduce`: the claims, and published friction beside every model."""
