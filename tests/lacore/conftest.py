"""What tests of lacore have in common."""

from math import nan

import pytest


@pytest.fixture(autouse=True, scope="module")
def ground_beyond():
    """Solve no problems with more ground, except where a module overrides this fixture.

    `lacore.solve` compares a soil that its box may hold back with up to eight larger and finer
    problems, only to add a sentence to its message. Without a load factor it adds none; all that
    leads up to the solves is still executed.
    """
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr("lacore.limit.boxed._associated", lambda _: nan)
        yield
