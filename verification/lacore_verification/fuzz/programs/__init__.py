"""Random programs of all classes and sizes, and checks of the answers of backends.

A program is a pure function of seed, family and number. Answers are checked by residuals and gaps
that are recomputed, statuses by proofs or by another backend; never by reports of the solver.
"""
