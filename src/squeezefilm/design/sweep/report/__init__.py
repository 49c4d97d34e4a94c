"""A sweep as a table, figures and files."""
