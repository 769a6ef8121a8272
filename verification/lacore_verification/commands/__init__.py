"""Command line: commands, their common options, and their output."""
