"""Ranges of load factors that are not unique, of blocks and continua (T14)."""
