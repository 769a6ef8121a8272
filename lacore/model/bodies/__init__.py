"""Three kinds of bodies, and the search for their touching edges."""
