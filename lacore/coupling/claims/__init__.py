"""Proofs of states without a load factor: locked, unsafe, free, and stable under dead loads."""
