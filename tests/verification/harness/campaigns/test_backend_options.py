"""Options of backends in a comparison, and what they come to in its results."""

from dataclasses import fields

import pandas as pd
import pytest

import lacore as la
from lacore_verification.harness.analysis.settings import MOST_SETTINGS, settings, with_settings
from lacore_verification.harness.campaigns.backend_options import read_settings, with_options
from lacore_verification.harness.campaigns.comparison import plan


def planned(couplings=()):
    return plan(["prandtl-punch:smooth"], ["clarabel", "highs"], ["coarse"], couplings)


def test_values_have_the_types_of_the_options():
    found = read_settings(["clarabel.tolerance=1e-6,clarabel.max_iterations=50"])
    assert found == {"clarabel": [{"tolerance": 1e-6, "max_iterations": 50}]}
    assert isinstance(found["clarabel"][0]["max_iterations"], int)


def test_options_that_are_given_apart_are_one_setting():
    apart = read_settings(["clarabel.tolerance=1e-6", "clarabel.max_iterations=50"])
    assert apart == read_settings(["clarabel.tolerance=1e-6, clarabel.max_iterations=50"])


def test_an_option_that_is_given_again_begins_another_setting():
    found = read_settings(["clarabel.tolerance=1e-6", "clarabel.tolerance=1e-9"])
    assert found == {"clarabel": [{"tolerance": 1e-6}, {"tolerance": 1e-9}]}
    both = ["clarabel.tolerance=1e-6,clarabel.max_iterations=50", "clarabel.tolerance=1e-9"]
    assert read_settings(both)["clarabel"][1] == {"tolerance": 1e-9}


def test_the_default_value_is_the_default_setting():
    default = la.find_backend("clarabel").Options().tolerance
    found = read_settings([f"clarabel.tolerance={default}", "clarabel.tolerance=1e-6"])
    assert found == {"clarabel": [{}, {"tolerance": 1e-6}]}
    (run,) = [run for run in planned() if run.backend == "clarabel"]
    same = with_options([run], [f"clarabel.tolerance={default}"])
    assert [own.key for own in same] == [run.key]


def test_a_changed_option_is_another_run():
    runs = planned()
    changed = with_options(runs, ["clarabel.tolerance=1e-6", "clarabel.tolerance=1e-9"])
    assert [(run.backend, run.options_text) for run in changed] == [
        ("clarabel", "tolerance=1e-06"),
        ("clarabel", "tolerance=1e-09"),
        ("highs", ""),
    ]
    assert len({run.key for run in (*runs, *changed)}) == 4
    assert [run.insist for run in changed] == [False, False, True]


def test_brackets_choose_their_options():
    (run,) = [run for run in planned(["bracket"]) if run.backend == "clarabel"]
    with pytest.raises(la.InputError, match="no run here"):
        with_options([run], ["clarabel.tolerance=1e-6"])
    both = with_options([run, *planned()], ["clarabel.tolerance=1e-6"])
    assert [own.options_text for own in both] == ["", "tolerance=1e-06", ""]


@pytest.mark.parametrize(
    ("text", "match"),
    [
        ("clarabell.tolerance=1", r"did you mean 'clarabel'\? .* lists the \d+ that are"),
        ("clarabel.tolerence=1", r"did you mean 'tolerance'\? Options .*: tolerance=1e-10, max_it"),
        ("clarabel.max_iterations=1.5", "not a whole number"),
        ("clarabel.tolerance=-1", r"clarabel.tolerance = -1.0: not a positive number"),
        ("clarabel.tolerance", "write NAME.OPTION=VALUE"),
        ("clarabel=1", "write NAME.OPTION=VALUE"),
        ("1e-6,clarabel.tolerance=1e-4", "write NAME.OPTION=VALUE"),
        ("clarabel.tolerance=1e-6,", "write NAME.OPTION=VALUE"),
        ("clarabel.tolerance=1e-6,much", "much"),
        ("newton.tolerance=1e-6", r"no run here; add it: --backends newton"),
    ],
)
def test_what_cannot_be_right_is_named(text, match):
    with pytest.raises(la.InputError, match=match):
        with_options(planned(), [text])


def test_further_values_of_an_option_repeat_the_setting_before():
    found = read_settings(["clarabel.max_iterations=50,clarabel.tolerance=1e-2,1e-4, 1e-10"])
    changed = {"max_iterations": 50}
    assert found["clarabel"] == [
        {**changed, "tolerance": 1e-2},
        {**changed, "tolerance": 1e-4},
        changed,
    ]


def rows(options):
    columns = {"backend": "a", "answered_by": ["a", "b"] * (len(options) // 2)}
    return pd.DataFrame({**columns, "options": options, "option_t": options})


def test_few_settings_of_a_backend_are_compared_as_backends():
    found = with_settings(rows(["", "", "t=1", "t=1"]))
    assert found["backend"].tolist() == ["a", "a", "a t=1", "a t=1"]
    assert found["answered_by"].tolist() == ["a", "b", "a t=1", "b"]
    assert found["option_t"].isna().tolist() == [False, False, True, True]
    many = rows([f"t={i}" for i in range(MOST_SETTINGS + 1)])
    assert with_settings(many).equals(many)


def test_settings_list_every_option_of_every_backend():
    found = settings(with_options(planned(), ["clarabel.tolerance=1e-6"]))
    own = found[found["backend"] == "clarabel"].set_index("option")
    assert list(own.index) == [field.name for field in fields(la.find_backend("clarabel").Options)]
    assert own.loc["tolerance", ["value", "default", "changed"]].tolist() == [
        *("1e-06", "1e-10", True),
    ]
    assert set(own["setting"]) == {"tolerance=1e-06"}
    other = found[found["backend"] == "highs"]
    assert set(other["setting"]) == {"default"}
    assert not other["changed"].any()
