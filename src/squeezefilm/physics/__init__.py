"""Physics from volts to what a finger feels: plate, film, contact, chain, rendering, perception."""
