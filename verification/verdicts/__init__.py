"""Pass or FAIL, and why: of load factors, brackets and paths; and how many of each."""
