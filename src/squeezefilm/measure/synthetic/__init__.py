"""A bench without instruments: noisy recordings of a display whose true values are drawn."""
