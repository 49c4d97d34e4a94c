"""Questions about plates, discs and rings: modes, response, sensitivities."""
