"""Texts, findings and errors with their values, statuses, and requests for pictures."""
