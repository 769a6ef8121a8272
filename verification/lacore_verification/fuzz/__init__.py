"""Random small problems, each judged by checks that share no code with solvers or certificates.

A problem is a recipe first: plain data, a pure function of seed, class and number. Copies that must
have a load that is known from the first (moved, turned, rescaled, renamed), smaller ones that are
still wrong, and what is stored are recipes, too.
"""
