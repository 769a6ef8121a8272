"""Long paths on the disk: read back as they were, or refused."""
