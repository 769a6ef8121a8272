"""What is run, and what a run leaves: plain data."""
