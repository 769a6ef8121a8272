"""Pictures of blocks in space."""
