"""What errors say: the field, the value, the fix, in a line that can be read."""

import inspect
import pickle
import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from types import NoneType
from typing import Any, get_type_hints

import numpy as np
import pytest

import lacore as la
from lacore.numerics.arrays import Floats
from lacore.paths.control import Control
from lacore.program.certificate import certify
from lacore.program.kinematic import associated_contact
from lacore.reporting.errors import InputError, kinds_of, suggest


def test_a_value_is_written_as_it_is_unless_it_would_fill_pages():
    assert (
        str(InputError("mu", -1.0, "negative", "give mu >= 0"))
        == "mu = -1.0: negative; give mu >= 0"
    )
    wrong = InputError("problem", {"x": np.arange(500.0).tolist()}, "not a problem", "give one")
    assert str(wrong) == "problem = <dict>: not a problem; give one"
    assert len(wrong.value["x"]) == 500


def test_a_name_is_suggested_where_it_may_have_been_meant():
    """One that shares half of its letters by chance is none: then those that there are."""
    assert suggest("clarable", ["clarabel", "ipopt"]) == "did you mean 'clarabel'?"
    assert suggest("nn", ["nx", "shape"]) == "did you mean 'nx'?"
    assert suggest("linprog", ["clarabel", "ipopt"]) == "known names: clarabel, ipopt"


def test_an_error_survives_pickling():
    error = InputError("mu", -1.0, "negative", "give mu >= 0")
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.value) == (str(error), error.value)


def test_a_public_name_that_is_mistyped_is_suggested():
    with pytest.raises(AttributeError, match=r"no 'lowerbound'; did you mean 'lower_bound'\?"):
        la.lowerbound  # noqa: B018


PUBLIC = [getattr(la, name) for name in la.__all__]
JUDGED = [
    pytest.param(function, name, id=f"{function.__qualname__}: {name}")
    for function in (*filter(inspect.isfunction, PUBLIC), la.LimitState.certify, certify)
    for name, hint in get_type_hints(function).items()
    if name != "return" and kinds_of(hint)
]


@pytest.mark.parametrize(("function", "name"), JUDGED)
def test_what_is_of_another_kind_is_refused_by_name(function, name):
    """Before the function looks at anything: nothing else is given."""
    wrong = [3, la.VonMises(1.0), [1, "a"]]
    if NoneType not in kinds_of(get_type_hints(function)[name]):
        wrong.append(None)
    for value in wrong:
        with pytest.raises(InputError, match=rf"^{name}\b.*; give ") as error:
            function(**{name: value})
        assert error.value.value is value


@pytest.mark.parametrize(
    ("hint", "kinds"),
    [
        (la.Problem | None, (la.Problem, NoneType)),
        (str | Path | None, (str, Path, NoneType)),
        (Mapping[str, float], (Mapping,)),
        (Callable[[float], float], (Callable,)),
        *[(hint, ()) for hint in (float, str | None, int | la.AdaptiveSteps, Any, Control)],
        *[(hint, ()) for hint in (tuple[float, float], la.Problem | Any, Floats | None)],
    ],
)
def test_numbers_names_arrays_and_protocols_are_not_judged_by_kind(hint, kinds):
    assert kinds_of(hint) == kinds


def test_a_wrong_kind_says_what_to_give():
    for wrong, said in {
        lambda: la.solve("wall"): "problem = 'wall': no Problem or Discretisation; give a lacore.P",
        lambda: la.solve(None): "problem: None: no Problem or Discretisation",
        lambda: la.lower_bound(la.discretise(la.examples.footing())): "that of a state is state.d",
        lambda: la.read_problem(3): "path = 3: no path; give a path",
        lambda: la.stable(la.examples.column(), options=3): "no mapping; give {'name': ...}, or l",
        lambda: la.sequential(la.examples.column(), 1.0, on_step=3): "cannot be called; give a fu",
        lambda: la.sensitivity(la.examples.column()): "no LimitState; give what lacore.solve ret",
    }.items():
        with pytest.raises(InputError, match=re.escape(said)):
            wrong()


def test_a_state_of_another_program_is_not_certified():
    """Nor what is none: an answer without a point, say."""
    punch, column = la.discretise(la.examples.footing()), la.discretise(la.examples.column())
    state = la.solve(column, coupling="associated").point
    with pytest.raises(InputError, match=r"state: has a|state: has stresses"):
        certify(punch.full, state)
    with pytest.raises(InputError, match=r"^state: None.*status"):
        certify(column.full, None)
    fewer = associated_contact(column.full.contact)
    fewer = replace(fewer, **{name: own[1:] for name, own in vars(fewer).items()})
    with pytest.raises(InputError, match="contact: of 1 points"):
        certify(column.full, state, fewer)


def test_a_structure_that_collapses_is_no_matter_of_the_backend():
    state = la.solve(la.examples.column(), coupling="associated")
    unsafe, stalled = (
        replace(state, status=own, findings=()).unanswered("clarabel")
        for own in (la.Status.UNSAFE, la.Status.STALLED)
    )
    assert str(unsafe).startswith("unsafe: ")
    assert str(stalled).startswith("backend 'clarabel' has no certified answer: stalled: ")
