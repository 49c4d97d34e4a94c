"""Questions about friction: how much, how sure, by which model."""
