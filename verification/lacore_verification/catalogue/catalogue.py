"""Cases by id. Those of `lacore_verification.cases` are found automatically."""

import pkgutil
from collections import ChainMap
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from importlib import import_module

from lacore.reporting.errors import InputError, require_known, suggest
from lacore_verification import cases
from lacore_verification.case import KINDS, Case, Variant


@dataclass(frozen=True, eq=False)
class Catalogue(Mapping[str, Case]):
    """Cases by id.

    Attributes:
        cases: cases in the order in which they are run; those of lacore are imported on first use.
        sources: origin of each case, for messages.
        broken: errors of cases that could not be loaded, by name.
    """

    cases: Mapping[str, Case]
    sources: Mapping[str, str]
    broken: Mapping[str, InputError] = field(default_factory=dict)

    def __getitem__(self, key: str) -> Case:
        return self.cases[key]

    def __iter__(self) -> Iterator[str]:
        return iter(self.cases)

    def __len__(self) -> int:
        return len(self.cases)

    def __contains__(self, key: object) -> bool:
        return key in self.cases

    def extended(self, case: Case, source: str) -> "Catalogue":
        """Return the catalogue with a case of another source, whose id is new."""
        both = ChainMap({case.id: case}, self.cases)  # type: ignore[arg-type]  # never written to
        return Catalogue(both, {**self.sources, case.id: source}, self.broken)


class _Files(Mapping[str, Case]):
    """Cases by id, which is the name of their file, so that names need no import."""

    def __init__(self) -> None:
        files = pkgutil.iter_modules(cases.__path__)
        found = sorted(file.name for file in files if not file.ispkg)
        self._modules = {name.replace("_", "-"): f"{cases.__name__}.{name}" for name in found}

    def __getitem__(self, key: str) -> Case:
        module = self._modules[key]
        case: Case = import_module(module).CASE
        if case.id != key:
            raise ValueError(f"{module} has the case {case.id!r}: it must be called after its file")
        return case

    def __iter__(self) -> Iterator[str]:
        return iter(self._modules)

    def __len__(self) -> int:
        return len(self._modules)

    def __contains__(self, key: object) -> bool:
        return key in self._modules


@cache
def catalogue() -> Catalogue:
    """Return the cases of lacore itself, in the order of their files."""
    found = _Files()
    return Catalogue(found, dict.fromkeys(found, "lacore"))


def find(name: str, known: Catalogue | None = None) -> tuple[Case, tuple[Variant, ...]]:
    """Return a case and its variants from ``id``, or the single variant of ``id:variant``.

    Args:
        name: name of a case.
        known: catalogue to search; None: the cases of lacore.

    Raises:
        InputError: an unknown name, or that of a case that could not be loaded.
    """
    known = catalogue() if known is None else known
    case_id, _, variant_name = name.partition(":")
    if case_id in known.broken:
        raise known.broken[case_id]
    if case_id not in known:
        closest = suggest(case_id, known)
        fix = closest if closest.endswith("?") else "`lacore cases` lists all cases"
        raise InputError("case", case_id, "unknown name", fix)
    case = known[case_id]
    if not variant_name:
        return case, tuple(case.variants)
    variants = {variant.name: variant for variant in case.variants}
    require_known(f"variant of case {case_id!r}", variant_name, variants)
    return case, (variants[variant_name],)


def tagged(known: Catalogue, tags: Sequence[str]) -> list[Case]:
    """Return the cases that have all of the tags.

    Raises:
        InputError: a tag without a case, or several without a common case.
    """
    there = {tag for case in known.values() for tag in case.tags}
    for tag in tags:
        if tag not in {*there, *KINDS}:
            raise InputError("--tag", tag, "no case has it", suggest(tag, there))
    found = [case for case in known.values() if set(tags) <= set(case.tags)]
    if not found:
        raise InputError("--tag", ",".join(tags), "no case has all of these tags", "name fewer")
    return found
