"""Reports: an index, a page a case and a study, and the pictures that they share."""
