"""Machinery for a real plate, or its twin: wire, device, loop and record, bench."""
