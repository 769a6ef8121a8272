"""Durable rows, what must hold before they are believed, and tables of them."""
