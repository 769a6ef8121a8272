"""Work in another process, which can be stopped."""
