"""New meshes of deformed bodies: outline, sizes, quality of the old elements."""
