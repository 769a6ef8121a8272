"""Both bounds on meshes that are refined where the gap is (T26)."""
