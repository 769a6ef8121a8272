"""Sections on all runs together: convergence, and backends side by side."""
