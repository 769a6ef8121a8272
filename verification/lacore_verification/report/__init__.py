"""Reports: an index, one page for each case, study and problem file, and their pictures."""
