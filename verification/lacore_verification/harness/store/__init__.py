"""Durable rows, their provenance, their checks, and tables of them."""
