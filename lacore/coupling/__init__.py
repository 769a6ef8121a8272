"""Loops on contact reactions (T9-T14), and proofs of states without a load factor."""
