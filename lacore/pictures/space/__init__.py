"""Pictures of three-dimensional problems."""
