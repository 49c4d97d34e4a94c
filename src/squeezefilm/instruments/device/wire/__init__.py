"""The wire protocol: bytes, frames, messages, and the host's side of the line."""
