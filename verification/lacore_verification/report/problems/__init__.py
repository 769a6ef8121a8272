"""A user's problem from a file: requested analyses, with results as text and on a page."""
