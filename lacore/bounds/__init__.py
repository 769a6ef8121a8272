"""Load factors from below and from above, proven (T22-T26)."""
