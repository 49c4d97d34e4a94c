"""The areas of the lab, one class each: the messages it answers."""
