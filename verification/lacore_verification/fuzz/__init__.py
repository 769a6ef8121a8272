"""Random small problems, each checked by code independent of solvers and certificates.

A problem is first a recipe: plain data, a pure function of seed, class and number. Copies with a
known load (moved, rotated, rescaled, renamed), reduced failing problems and stored ones are
recipes, too.
"""
