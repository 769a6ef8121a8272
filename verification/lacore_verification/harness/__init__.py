"""Runs of cases: planning, execution, verdicts, stored results, checks and their evaluation."""
