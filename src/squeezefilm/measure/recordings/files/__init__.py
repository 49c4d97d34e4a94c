"""Files of instruments as tables of numbers, whatever they hold."""
