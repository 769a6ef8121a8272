"""What must hold of a state, by code that shares nothing with the solver."""
