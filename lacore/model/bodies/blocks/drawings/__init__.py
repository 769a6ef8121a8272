"""Blocks from drawings: lines of files, merged where they nearly meet, closed to outlines."""
