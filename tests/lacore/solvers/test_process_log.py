"""What processes print is kept, up to a limit, and apart from what comes before and after."""

import subprocess
import sys

import pytest

from lacore.solvers.process_log import ProcessLog

pytestmark = pytest.mark.skipif(sys.platform == "win32", reason="processes are not logged there")


def printed(log, code):
    with open(log.open(), "wb") as pipe:
        subprocess.run([sys.executable, "-c", code], stderr=pipe, check=True)
    return log.take()


def test_each_process_has_its_own_text():
    log = ProcessLog()
    assert log.take() == ""
    assert printed(log, "import sys; sys.stderr.write('one')") == "one"
    assert printed(log, "import sys; sys.stderr.write('two\\xe9')") == "two\xe9"
    assert printed(log, "") == log.take() == ""


def test_the_end_of_a_long_text_is_kept():
    text = printed(ProcessLog(1000), "import sys; sys.stderr.write('x' * 10**6 + 'end')")
    assert text == "(only the last 1000 bytes are kept)\n" + "x" * 997 + "end"


def test_any_bytes_become_text():
    assert printed(ProcessLog(), "import os; os.write(2, b'a\\xffb')") == "a\ufffdb"


def test_a_process_that_never_stops_writing_holds_up_nobody():
    log = ProcessLog(100)
    with open(log.open(), "wb") as pipe:
        code = "while True: print('spam', flush=True)"
        process = subprocess.Popen([sys.executable, "-c", code], stdout=pipe)
    try:
        while "spam" not in log.take():
            pass
        assert len(log.take()) < 200
    finally:
        process.kill()
        process.wait()
