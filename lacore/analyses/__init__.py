"""Analyses of many limit problems: ranges, safety, sensitivity, critical values, envelopes."""
