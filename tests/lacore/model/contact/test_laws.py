"""Friction between two bodies of unlike strengths."""

import numpy as np
import pytest

import lacore as la


def between(strengths, friction):
    """Two squares on each other, of two strengths."""
    bodies = {
        name: la.Body(la.meshes.rectangle((0, 1), (low, low + 1), 1, 1), la.VonMises(strength))
        for name, low, strength in zip(("low", "top"), (0, 1), strengths, strict=True)
    }
    return la.Problem(
        bodies,
        [la.Traction("top", "top", (1, 0))],
        [la.Fix("low", "bottom")],
        [la.Interface(("top", "bottom"), ("low", "top"), friction)],
    )


@pytest.mark.parametrize("strengths", [(1.0, 1e6), (1e6, 1.0)])
def test_more_than_the_weaker_body_could_ever_carry_sticks(strengths):
    """A limit of 1 000 times the strength of one of the bodies never slips, whichever it is."""
    limit = la.discretise(between(strengths, la.Tresca(1e3))).program.contact.limit
    assert np.all(np.isinf(limit))
    for associated in (False, True):
        strong = la.Coulomb(0.5, associated, adhesion=1e3)
        rows = la.discretise(between(strengths, strong)).program.contact
        assert np.all(np.isinf(rows.limit))
        assert not rows.coefficient.any()  # what sticks neither rubs nor dilates
        assert not rows.dilatancy.any()
    with pytest.raises(la.InputError, match="nothing would ever"):
        la.discretise(between(strengths, la.Coulomb(0.5, adhesion=1e3, tension=1e3)))


def test_what_both_bodies_could_carry_slips():
    limit = la.discretise(between((1e6, 1e6), la.Tresca(1e3))).program.contact.limit
    assert np.all(limit == 1e3)
