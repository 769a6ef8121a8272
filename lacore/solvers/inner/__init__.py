"""One inner solve by a backend: in scaled units, with strong bodies as rigid ones first."""
