"""The description of a case: explanation, hand calculation, references, tolerances."""

from collections.abc import Iterator, Mapping, Sequence

from lacore_verification.case import Case, Variant
from lacore_verification.report.blocks import Block, Columns, Heading, Preformatted, Text


def lead(case: Case) -> str:
    """Describe a case in one line."""
    return f"{case.id} · {', '.join(case.tags)} · load factor in {case.unit}"


def counted(number: int, noun: str) -> str:
    """Return a count with its noun: ``1 case``, ``2 cases``."""
    return f"{number} {noun}" + ("" if number == 1 else "s")


def description(case: Case, variants: Sequence[Variant], elements: Mapping[str, int]) -> Columns:
    """Put the explanation next to the hand calculation, the references and the tolerances.

    Args:
        case: Case to describe.
        variants: Its variants to describe.
        elements: Number of elements of the mesh whose tolerance is explained, by variant.
    """
    right: list[Block] = [Heading("Hand calculation"), Preformatted(case.hand_calculation)]
    right += [Heading("Reference"), *_references(case, variants), *_unfit(variants)]
    reasons = list(_reasons(case, variants, elements))
    if reasons:
        right += [Heading("Tolerance"), *reasons]
    return Columns(list(_explanation(case)), right)


def _explanation(case: Case) -> Iterator[Block]:
    """Yield paragraphs; indented ones are a sketch."""
    for block in case.explanation.strip("\n").split("\n\n"):
        if all(line.startswith("  ") for line in block.splitlines()):
            yield Preformatted(block, sketch=f"Sketch of {case.title}")
        else:
            yield Text(block)


def _references(case: Case, variants: Sequence[Variant]) -> Iterator[Text]:
    """Yield each formula with its source once, under the values of the variants that have it."""
    values: dict[str, list[str]] = {}
    for variant in variants:
        reference = case.reference_of(variant)
        kinds = [(reference, "")]
        if reference.associated is not None:
            kinds.append((reference.of_associated(), ", associated"))
        for one, suffix in kinds:
            text = f"{one.formula} ({one.kind}; {one.source})"
            values.setdefault(text, []).append(f"{variant.name}{suffix}: {one.text}")
    for text, own in values.items():
        yield Text(text, lead=", ".join(own))


def _unfit(variants: Sequence[Variant]) -> Iterator[Text]:
    for variant in variants:
        for name, why in variant.unfit.items():
            yield Text(why, lead=f"{variant.name}: not applicable, {name}")


def _reasons(
    case: Case, variants: Sequence[Variant], elements: Mapping[str, int]
) -> Iterator[Text]:
    """Yield the reasons for the tolerances, each once."""
    names: dict[str, list[str]] = {}
    for variant in variants:
        if variant.name in elements:
            reason = case.band_of(variant, elements[variant.name]).reason
            names.setdefault(reason, []).append(variant.name)
    for reason, own in names.items():
        yield Text(reason, lead=", ".join(own))
