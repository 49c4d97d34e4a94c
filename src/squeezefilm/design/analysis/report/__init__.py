"""The report of `analyze`: its page and its figures."""
