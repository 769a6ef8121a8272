"""Durable rows, where they come from, what they are believed by, and tables of them."""
