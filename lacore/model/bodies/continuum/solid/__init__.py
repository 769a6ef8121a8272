"""Bodies of tetrahedra: their faces, what holds them, and velocities that jump along faces."""
