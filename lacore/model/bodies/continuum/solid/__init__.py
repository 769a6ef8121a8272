"""Bodies of tetrahedra: their faces, supports, and velocity jumps along faces."""
