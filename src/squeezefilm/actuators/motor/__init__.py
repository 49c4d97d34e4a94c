"""A planar standing-wave ultrasonic motor: a slider on feet that touch a vibrating plate now and then."""
