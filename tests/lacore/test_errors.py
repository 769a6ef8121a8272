"""What errors say: the field, the value, the mend, in a line that can be read."""

import pickle

import numpy as np
import pytest

import lacore as la
from lacore.errors import InputError, suggest


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
