"""A standing-wave ultrasonic motor: a slider on feet of a plate, which it meets now and then."""
