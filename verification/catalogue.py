"""The catalogue: every case file in `verification.cases`, found by itself."""

import pkgutil
from functools import cache
from importlib import import_module
from types import MappingProxyType

from lacore.errors import require_known
from verification import cases
from verification.case import Case, Variant


@cache
def catalogue() -> MappingProxyType[str, Case]:
    """All cases by id, in the order of their files."""
    found: dict[str, Case] = {}
    for module in sorted(pkgutil.iter_modules(cases.__path__), key=lambda entry: entry.name):
        case: Case = import_module(f"{cases.__name__}.{module.name}").CASE
        if case.id in found:
            raise ValueError(f"two case files have the id {case.id!r}")
        found[case.id] = case
    return MappingProxyType(found)


def find(name: str) -> tuple[Case, tuple[Variant, ...]]:
    """A case and its variants from ``id``, or the one variant of ``id:variant``.

    Raises:
        InputError: an unknown name.
    """
    case_id, _, variant_name = name.partition(":")
    require_known("case", case_id, catalogue())
    case = catalogue()[case_id]
    if not variant_name:
        return case, case.variants
    variants = {variant.name: variant for variant in case.variants}
    require_known(f"variant of case {case_id!r}", variant_name, variants)
    return case, (variants[variant_name],)
