"""Which Coulomb load factors there are: ranges of blocks and of continua (T14)."""
