"""Contents of mesh files: formats, kinds of elements, curved edges, and notes on what was read."""
