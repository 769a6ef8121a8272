"""New meshes along a path: when they are made, and what is transferred to them."""
