"""Assembly of the kinematic program of a problem (T6)."""
