"""What reaches the finger of what was asked for: whole strokes, and numbers that compare them."""
