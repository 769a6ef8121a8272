"""Checks of the fields of a case, for cases of users before any of them runs."""

import inspect
import pickle
import re
from collections.abc import Callable, Mapping, Sequence
from math import isinf, isnan
from numbers import Real
from typing import Any

import lacore as la
from lacore.reporting.errors import (
    InputError,
    is_number,
    require_count,
    suggest,
)
from lacore_verification.case import UNKNOWN_KINDS, Band, Case, Order, Reference, Variant
from lacore_verification.case.band import Bracketing
from lacore_verification.case.case import described
from lacore_verification.case.following import STEPPING, Following
from lacore_verification.catalogue.first_checks import check_first

# characters allowed in files, lists with commas, and id:variant
_NAME = re.compile(r"[A-Za-z0-9][A-Za-z0-9._-]*")
_TEXTS = ("title", "unit", "explanation", "hand_calculation")
_ELEMENTS = 1000  # number of elements of a mesh for the check of a band
_LADDER = 4  # number of sizes: fewer give almost no confidence interval of a slope


def check(case: Case) -> None:
    """Check all that can be checked without building or solving a problem.

    `Case.reference`, `Case.band` and `Case.order` are called once a variant.

    Raises:
        InputError: a field that cannot be right; it names it as ``Case.title``.
    """
    _check_name("Case.id", case.id)
    for field in _TEXTS:
        _check_text(f"Case.{field}", getattr(case, field))
    if "\n" in case.title:
        raise InputError("Case.title", None, "has several lines", "give one")
    _check_tags(case.tags)
    _check_meshes(case.meshes)
    for field in ("build", "reference", "band"):
        _check_callable(f"Case.{field}", getattr(case, field))
    for field in ("valid", "order", "path", "sketch"):
        if getattr(case, field) is not None:
            _check_callable(f"Case.{field}", getattr(case, field))
    _check_bracket(case)
    _check_picklable(case)
    _check_variants(case)
    check_first(case)
    for variant in case.variants:
        _check_signatures(case, variant)
        _check_reference(variant, _called(case.reference, "reference", variant))
        _check_band(variant, _called(case.band, "band", variant, _ELEMENTS))
        if case.order is not None:
            _check_order(case, variant, _called(case.order, "order", variant))
        if case.path is not None:
            _check_following(variant, _called(case.path, "path", variant))
    if case.sweep:
        _check_sweep(case)


def _check_name(field: str, name: object) -> None:
    if not isinstance(name, str) or not _NAME.fullmatch(name):
        raise InputError(
            field,
            name,
            "not a name that commands and files can carry",
            "use letters, digits, '-', '_' and '.', as in 'my-case'",
        )


def _check_text(field: str, text: object) -> None:
    if not isinstance(text, str) or not text.strip():
        shown = text if isinstance(text, str) else type(text).__name__
        raise InputError(field, shown, "says nothing", "write it out: people read the case by it")


def _check_callable(field: str, function: object) -> None:
    if not callable(function):
        raise InputError(field, type(function).__name__, "not a function", "give one")


def _check_tags(tags: object) -> None:
    if not isinstance(tags, tuple) or not all(isinstance(t, str) and t.strip() for t in tags):
        raise InputError("Case.tags", tags, "not words in a tuple", "write ('blocks', 'contact')")


def _check_meshes(meshes: object) -> None:
    if not isinstance(meshes, Mapping) or not meshes:
        raise InputError(
            "Case.meshes",
            type(meshes).__name__,
            "names no level",
            "give {'coarse': {...}, 'medium': {...}}, or leave it out if there are no meshes",
        )
    for name, size in meshes.items():
        _check_name("Case.meshes, a level", name)
        if not isinstance(size, Mapping):
            raise InputError(
                f"Case.meshes[{name!r}]",
                type(size).__name__,
                "not keyword arguments of build()",
                "give a dict such as {'n': 8}",
            )


def _check_bracket(case: Case) -> None:
    stated = case.bracket
    if stated is None:
        return
    if not isinstance(stated, Bracketing):
        kind = type(stated).__name__
        raise InputError("Case.bracket", kind, "no Bracketing", "give a Bracketing, or None")
    if not (is_number(stated.target_width) and stated.target_width > 0):
        raise InputError(
            "Case.bracket.target_width", stated.target_width, "not a width", "give a number > 0"
        )
    require_count("Case.bracket.max_elements", stated.max_elements)
    if stated.mesh and stated.mesh not in case.meshes:
        raise InputError(
            "Case.bracket.mesh",
            stated.mesh,
            "unknown level",
            suggest(str(stated.mesh), case.meshes),
        )
    for field in ("below", "above"):
        value = getattr(stated, field)
        if not (is_number(value) and value >= 0):
            raise InputError(
                f"Case.bracket.{field}", value, "not a size of an error", "give a number >= 0"
            )
    if stated.straightened:
        _check_text("Case.bracket.reason", stated.reason)


def _check_picklable(case: Case) -> None:
    """Check that a case can be sent to other processes, with functions by name."""
    for field in ("build", "reference", "band", "valid", "order", "path", "sketch"):
        try:
            pickle.dumps(getattr(case, field))
        except (pickle.PicklingError, AttributeError, TypeError) as error:
            raise InputError(
                f"Case.{field}",
                None,
                "other processes cannot find it by name",
                "define it at the top level of the file with def, not inside a function or as a"
                " lambda",
            ) from error


def _check_variants(case: Case) -> None:
    variants = case.variants
    if not isinstance(variants, Sequence) or not variants:
        raise InputError(
            "Case.variants", None, "there is none", "give at least (Variant('plain', {}),)"
        )
    names: set[str] = set()
    for index, variant in enumerate(variants):
        where = f"Case.variants[{index}]"
        if not isinstance(variant, Variant):
            raise InputError(where, type(variant).__name__, "not a Variant", "give a Variant")
        _check_name(f"{where}.name", variant.name)
        if variant.name in names:
            raise InputError(f"{where}.name", variant.name, "is there twice", "rename one")
        names.add(variant.name)
        for field in ("parameters", "unfit"):
            if not isinstance(getattr(variant, field), Mapping):
                raise InputError(f"{where}.{field}", None, "not a mapping", "give a dict")
        for name, value in variant.parameters.items():
            if not isinstance(value, Real | str) or value != value:
                raise InputError(
                    f"{where}.parameters[{name!r}]",
                    value if isinstance(value, Real) else type(value).__name__,
                    "not a number, a word, True or False",
                    "give one of them: a column of the results shows it",
                )
        if not isinstance(variant.meshes, tuple | list):
            raise InputError(
                f"{where}.meshes", variant.meshes, "not names in a tuple", "write ('fine',)"
            )
        for mesh in variant.meshes:
            if mesh not in case.meshes:
                raise InputError(
                    f"{where}.meshes", mesh, "unknown level", suggest(str(mesh), case.meshes)
                )


def _check_signatures(case: Case, variant: Variant) -> None:
    parameters = variant.parameters
    for level, size in case.meshes.items():
        twice = sorted(set(size) & set(parameters))
        if twice:
            raise InputError(
                f"Case.meshes[{level!r}]",
                twice[0],
                f"is a parameter of variant {variant.name!r} too",
                "leave it in one of them",
            )
        _check_takes(case.build, "build", variant, **size, **parameters)
    _check_takes(case.reference, "reference", variant, **parameters)
    _check_takes(case.band, "band", variant, _ELEMENTS, **parameters)
    for name in ("valid", "order", "path"):
        function = getattr(case, name)
        if function is not None:
            _check_takes(function, name, variant, **parameters)


def _check_takes(
    function: Callable[..., Any], name: str, variant: Variant, *elements: int, **given: Any
) -> None:
    try:
        inspect.signature(function).bind(*elements, **given)
    except (TypeError, ValueError) as error:
        raise InputError(
            f"Case.{name}",
            None,
            f"does not go with variant {variant.name!r}: {error}",
            f"let {name}() take {_arguments(elements, given)}",
        ) from error


def _arguments(elements: Sequence[int], given: Mapping[str, Any]) -> str:
    names = [*("elements" for _ in elements), *given]
    return ", ".join(names) if names else "no argument"


def _called(function: Callable[..., Any], name: str, variant: Variant, *elements: int) -> Any:
    try:
        return function(*elements, **variant.parameters)
    except Exception as error:  # errors of users' code
        raise InputError(
            f"Case.{name}",
            None,
            f"fails for variant {variant.name!r}: {described(error)}",
            f"fix {name}(), or the parameters of the variant",
        ) from error


def _check_reference(variant: Variant, reference: object) -> None:
    where = f"Case.reference, variant {variant.name!r}"
    if not isinstance(reference, Reference):
        raise InputError(where, type(reference).__name__, "no Reference", "return a Reference")
    if not isinstance(reference.status, la.Status):
        raise InputError(f"{where}, status", reference.status, "no status", "give a lacore.Status")
    if not _is_real(reference.value):
        raise InputError(
            f"{where}, value",
            reference.value,
            "not a number",
            "give a load factor, or NaN and a kind that says that none is known",
        )
    if isnan(reference.value) != reference.unknown:
        raise InputError(
            f"{where}, value",
            reference.value,
            f"does not go with the kind {reference.kind!r}",
            f"give a number; or, where none is known, NaN and kind={UNKNOWN_KINDS[0]!r}",
        )
    if reference.status is la.Status.SOLVED and isinf(reference.value):
        raise InputError(
            f"{where}, value",
            reference.value,
            "no load factor that a solve can end with",
            "give the status too: LOCKED or JAM for +inf, UNSAFE for -inf",
        )
    if not (is_number(reference.half_width) and reference.half_width >= 0):
        raise InputError(
            f"{where}, half_width", reference.half_width, "not a distance", "give a number >= 0"
        )
    if reference.up_to is not None and not (
        _is_real(reference.up_to) and reference.up_to >= reference.value
    ):
        raise InputError(
            f"{where}, up_to",
            reference.up_to,
            f"not above value = {reference.value!r}, the lower end",
            "give the upper end of the interval, or leave it out",
        )
    if reference.associated is not None and not (
        _is_real(reference.associated) and not isnan(reference.associated)
    ):
        raise InputError(
            f"{where}, associated", reference.associated, "not a number", "give one, or None"
        )
    for field in ("formula", "source", "kind"):
        _check_text(f"{where}, {field}", getattr(reference, field))


def _is_real(value: object) -> bool:
    """Return whether a value is a number, including infinite ones and NaN."""
    return isinstance(value, Real) and not isinstance(value, bool)


def _check_band(variant: Variant, band: object) -> None:
    where = f"Case.band, variant {variant.name!r}"
    if not isinstance(band, Band):
        raise InputError(where, type(band).__name__, "no Band", "return a Band")
    for field in ("below", "above", "scale"):
        value = getattr(band, field)
        if not (is_number(value) and value >= 0):
            raise InputError(
                f"{where}, {field}", value, "not a size of an error", "give a finite number >= 0"
            )
    _check_text(f"{where}, reason", band.reason)


def _check_following(variant: Variant, stated: object) -> None:
    where = f"Case.path, variant {variant.name!r}"
    if not isinstance(stated, Following):
        raise InputError(where, type(stated).__name__, "no Following", "return a Following")
    for name in STEPPING:
        if variant.parameters.get(name) != getattr(stated, name):
            raise InputError(
                f"{where}, {name}",
                getattr(stated, name),
                f"is not the parameter {name!r} of the variant, so that no sweep could vary it",
                f"give the variant {name!r}, and take it from there",
            )
    if stated.ladder and (len(stated.ladder) < _LADDER or stated.exact is None):
        raise InputError(
            f"{where}, ladder",
            stated.ladder,
            "no order can be measured",
            f"give {_LADDER} numbers of steps or more, and the exact loads",
        )


def _check_order(case: Case, variant: Variant, order: object) -> None:
    where = f"Case.order, variant {variant.name!r}"
    if order is None:
        return
    if not isinstance(order, Order):
        raise InputError(where, type(order).__name__, "no Order", "return an Order, or None")
    if not isinstance(order.meshes, Sequence) or len(order.meshes) < _LADDER:
        raise InputError(
            f"{where}, meshes",
            len(order.meshes) if isinstance(order.meshes, Sequence) else None,
            f"fewer than {_LADDER} sizes give no slope that one could trust",
            f"give {_LADDER} or more",
        )
    for size in order.meshes:
        _check_takes(case.build, "build", variant, **size, **variant.parameters)
    for field in ("expected", "tolerance"):
        value = getattr(order, field)
        if not (is_number(value) and value > 0):
            raise InputError(f"{where}, {field}", value, "not a positive number", "give one")
    _check_text(f"{where}, reason", order.reason)


def _check_sweep(case: Case) -> None:
    for variant in case.variants:
        if not is_number(variant.parameters.get(case.sweep)):
            raise InputError(
                "Case.sweep",
                case.sweep,
                f"no number among the parameters of variant {variant.name!r}",
                "name a numeric parameter that all variants have, or leave it out",
            )
