"""Ranges of a number of a file."""

import pytest

from lacore.files.problem.source import Source
from lacore.reporting.errors import InputError
from tests.verification.report.problems.test_varying import BEAM


@pytest.mark.parametrize("ends", ["-9 kN:-1 kN/m", "-9 kN/m:-1 kN"])
def test_both_ends_of_a_range_have_one_kind_of_unit(tmp_path, ends):
    """A force on a frame may be given per metre as well; from one to the other is no range."""
    from lacore.files.problem.varied import read_varied  # here: pydantic takes a while to load

    file = tmp_path / "my.toml"
    file.write_text(BEAM, encoding="utf-8")
    for kind in ("kN", "kN/m"):
        found = read_varied(Source.of(file), f"vector[1]=-9 {kind}:-1 {kind}", "--vary")
        assert (found.low, found.high) == (-9e3, -1e3)
    with pytest.raises(InputError, match="units of one kind"):
        read_varied(Source.of(file), f"vector[1]={ends}", "--vary")
