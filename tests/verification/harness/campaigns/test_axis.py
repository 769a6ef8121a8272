"""What people write after --vary."""

import pytest

import lacore as la
from lacore_verification.harness.campaigns.axis import Axis, read_axis, read_value


@pytest.mark.parametrize(
    ("text", "axis"),
    [
        ("mu=0.1:0.5:5", Axis("", "mu", ("0.1", "0.2", "0.3", "0.4", "0.5"))),
        ("r=1e-1:1e-3:3:log", Axis("", "r", ("0.1", "0.01", "0.001"))),
        ("n=4:16:3:log", Axis("", "n", ("4", "8", "16"))),
        ("n=4:4:1", Axis("", "n", ("4",))),
        ("start=zero, associated", Axis("", "start", ("zero", "associated"))),
        ("option.tolerance=1e-6", Axis("option", "tolerance", ("1e-6",))),
        ("K_c=1", Axis("option", "bulk", ("1",))),
        ("option.K_n=1", Axis("option", "normal", ("1",))),
        ("K_t=1", Axis("option", "tangential", ("1",))),
        ("param.K_t=1", Axis("param", "K_t", ("1",))),
    ],
)
def test_axes(text, axis):
    assert read_axis(text) == axis


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("mu", "does not say what to vary"),
        ("=1", "does not say what to vary"),
        ("mu=", "the grid is empty"),
        ("mu=1,,2", "a value is missing"),
        ("mu=1:2", "not a range"),
        ("mu=1:2:3:4", "not a range"),
        ("mu=1:2:3:log:5", "not a range"),
        ("mu=1:2:0", "not a number of values"),
        ("mu=1:2:-3", "not a number of values"),
        ("mu=1:2:2.5", "not a number of values"),
        ("mu=1:2:1000000", "not a number of values"),
        ("mu=nan:2:3", "START = 'nan': not a finite number"),
        ("mu=1:inf:3", "STOP = 'inf': not a finite number"),
        ("mu=one:2:3", "START = 'one': not a finite number"),
        ("mu=0:1:3:log", "ends above 0"),
        ("mu=1:-1:3:log", "ends above 0"),
        ("options.r=1", "did you mean 'option'?"),
    ],
)
def test_what_cannot_be_right(text, message):
    with pytest.raises(la.InputError, match="vary") as caught:
        read_axis(text)
    assert message in str(caught.value)


def test_values_have_the_type_of_what_they_replace():
    assert read_value("x", "4.0", int) == 4
    assert isinstance(read_value("x", "4.0", int), int)
    assert isinstance(read_value("x", "4", float), float)
    assert read_value("x", "True", bool) is True
    assert read_value("x", "simplex", str) == "simplex"


@pytest.mark.parametrize(
    ("text", "kind"), [("4.5", int), ("x", float), ("nan", float), ("inf", int), ("1", bool)]
)
def test_values_of_another_type(text, kind):
    with pytest.raises(la.InputError, match=f"x = '{text}'"):
        read_value("x", text, kind)
