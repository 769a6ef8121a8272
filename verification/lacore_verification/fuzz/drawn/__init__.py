"""Random problems: drawn, built from their recipes, and copied in ways that change nothing."""
