"""Verdicts, with reasons: of limit states, brackets and paths; and their counts."""
