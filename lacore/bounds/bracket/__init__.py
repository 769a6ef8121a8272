"""Both bounds on meshes that grow where the gap is (T26)."""
