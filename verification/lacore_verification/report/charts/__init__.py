"""Charts: figures of results, their axes, lines and colours, as SVG."""
