"""Names of verification: where each is found, for `__init__` and for type checkers."""

from .harness.store.results import load_results as load_results
