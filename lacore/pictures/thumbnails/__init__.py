"""Thumbnails: the collapse mechanism alone, drawn for the size at which a page shows it."""
