"""The report of a comparison: figures, and one page that loads nothing from elsewhere."""
