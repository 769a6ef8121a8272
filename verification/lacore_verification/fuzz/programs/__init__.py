"""Random programs of all classes that backends see, of any size, and what their answers are worth.

A program is a pure function of seed, family and number. Answers are judged by residuals and gaps
that are recomputed, words by proofs or by another backend; never by what a solver says of itself.
"""
