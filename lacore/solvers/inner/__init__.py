"""One inner solve of a program by a backend: in good units, strong bodies as rigid ones first."""
