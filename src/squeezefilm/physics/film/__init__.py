"""The gas film between finger and plate: closed forms, periodic and transient solutions."""
