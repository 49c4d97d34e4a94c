"""The finger that slides, sticks and slips: dry friction, the march in time, what the skin does."""
