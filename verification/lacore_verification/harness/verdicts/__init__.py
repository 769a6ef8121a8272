"""Pass or FAIL, and why: of limit states, brackets and paths; and how many of each."""
