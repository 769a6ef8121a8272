"""Random problems: drawn, built from recipes, and copied with the same load factor."""
