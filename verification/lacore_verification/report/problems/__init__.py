"""A user's own problem from a file: what is asked of it, in words and on a page."""
