"""Charts: axes, lines, colours, as SVG."""
