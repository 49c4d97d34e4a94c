"""The gas film between finger and surface: closed forms and solvers. Knows nothing of the plate."""
