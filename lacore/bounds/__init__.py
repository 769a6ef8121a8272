"""Lower and upper bounds on load factors, and brackets of both (T22-T26)."""
