"""The time limit of an inner solve within a run."""

import lacore as la


def shorter_limit(backend: str, time_limit: float | None) -> dict[str, float]:
    """Options that limit a solve to the time of its run, if the backend sets no shorter limit.

    Args:
        backend: Its name.
        time_limit: Of the run, s; None: there is none.

    Raises:
        CapabilityError: The backend cannot be loaded or run here.
    """
    own = float(la.find_backend(backend).Options().time_limit)
    return {} if time_limit is None else {"time_limit": min(own, time_limit)}
