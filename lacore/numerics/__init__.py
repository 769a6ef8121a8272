"""Sparse matrices, linear programs and iterations, for loops, proofs and backends alike."""
