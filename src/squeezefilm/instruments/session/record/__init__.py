"""The record of a session: an append-only trace, and its export."""
