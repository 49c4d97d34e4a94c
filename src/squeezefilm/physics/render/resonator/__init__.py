"""The slow resonator: its envelope, the carrier, and compensation of its slowness."""
