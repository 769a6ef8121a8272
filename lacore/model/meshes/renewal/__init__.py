"""New meshes of bodies that have deformed: outline, sizes, quality of the old elements."""
