"""Files of ours that a command loads: a comparison plans and reports, and its processes solve."""

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[3]
MOST = 120
COUNT = """
import sys
from pathlib import Path
from lacore_verification.commands.cli import main
try:
    main({arguments!r})
except SystemExit as end:
    assert not end.code
root = Path({root!r})
files = {{Path(own.__file__) for own in sys.modules.values() if getattr(own, "__file__", None)}}
own = [file.relative_to(root) for file in files if file.is_relative_to(root)]
print(*(file for file in own if file.parts[0] in {packages!r}), sep="\\n", file=sys.stderr)
"""
PACKAGES = ("lacore", "backends", "verification")


def loaded(*arguments):
    """Files below the root of the repository that a command loads in its own process."""
    code = COUNT.format(arguments=list(arguments), root=str(ROOT), packages=PACKAGES)
    run = subprocess.run(
        [sys.executable, "-c", code], capture_output=True, text=True, check=True, cwd=ROOT
    )
    return [line for line in run.stderr.splitlines() if line.endswith(".py")]


@pytest.mark.slow
def test_a_comparison_on_one_case_loads_few_files(tmp_path):
    """Its four variants suffice for processes that draw them and write their programs."""
    words = ("compare", "block-slide", "--backends", "clarabel", "--out", str(tmp_path))
    files = loaded(*words)
    assert len(files) <= MOST, sorted(files)
    assert not [file for file in files if "fuzz" in file or "conformance" in file]


@pytest.mark.parametrize("name", ["backends", "new"])
def test_lists_load_no_problem(name):
    """Neither do they load what solves or draws it."""
    files = loaded(name)
    assert "verification/lacore_verification/commands/cli.py" in files
    assert not [file for file in files if file.startswith("lacore/model/")]
