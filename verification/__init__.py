"""Verification: cases with references, and the harness that compares backends with them."""

import os

# The solvers are serial, and BLAS threads that wait for work spin: beside any other load they slow
# a dense backend by a factor of ten and more. Before numpy is loaded; what the user set stays.
for _name in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"):
    os.environ.setdefault(_name, "1")
