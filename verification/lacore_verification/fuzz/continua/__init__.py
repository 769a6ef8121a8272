"""Checks of continua: virtual power, flow and the strength of soils."""
