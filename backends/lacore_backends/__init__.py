"""Backends: one file each, registered in the entry-point group ``lacore.backends``."""
