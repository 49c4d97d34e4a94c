"""What moves a real plate, or its twin: wire, device, loop and record, bench."""
