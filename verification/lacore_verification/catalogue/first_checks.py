"""Checks of what a case states about its runs in the first comparison."""

from lacore.reporting.errors import InputError, is_number, suggest
from lacore_verification.case import Case, First


def check_first(case: Case) -> None:
    """Check the names and the number in `Case.first`.

    Raises:
        InputError: One of them is wrong, or the first comparison would run nothing of the case.
    """
    first = case.first
    if not isinstance(first, First):
        raise InputError("Case.first", type(first).__name__, "not a First", "give a First")
    names = [variant.name for variant in case.variants]
    if first.variant and first.variant not in names:
        raise InputError(
            "Case.first.variant", first.variant, "unknown variant", suggest(first.variant, names)
        )
    if first.meshes is not None and not isinstance(first.meshes, tuple | list):
        raise InputError(
            "Case.first.meshes", first.meshes, "not names in a tuple", "write ('fine',)"
        )
    for mesh in first.meshes or ():
        if mesh not in case.meshes:
            raise InputError(
                "Case.first.meshes", mesh, "unknown level", suggest(str(mesh), case.meshes)
            )
    if not (is_number(first.bracket) and first.bracket >= 0):
        raise InputError("Case.first.bracket", first.bracket, "not a width", "give a number >= 0")
    if first.bracket and (case.bracket is None or not case.meshed):
        raise InputError(
            "Case.first.bracket",
            first.bracket,
            "no bracket can be computed: Case.bracket is None, or the bodies are rigid",
            "state Case.bracket, or leave the width out",
        )
    if first.meshes is not None and not first.meshes and not first.bracket:
        raise InputError(
            "Case.first.meshes",
            first.meshes,
            "names no mesh, and there is no bracket: nothing would be run",
            "name a mesh or a bracket, or leave it out",
        )
