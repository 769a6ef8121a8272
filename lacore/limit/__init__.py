"""One limit problem solved: its state, whether it stands, its interval."""
