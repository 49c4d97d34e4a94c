"""What a person feels: stimuli, the senses of the fingertip, percepts, and how people differ."""
