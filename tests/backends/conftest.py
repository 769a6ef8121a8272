"""What tests of backends share with those of lacore."""

from tests.lacore.conftest import ground_beyond

__all__ = ["ground_beyond"]
