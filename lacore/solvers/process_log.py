"""The last output of a process to its standard error, of limited size."""

import os
import select
import sys
import threading

LONGEST_LOG = 64 * 1024
"""Bytes that are kept of a log: the last ones."""
# number of reads at a time: more than a pipe holds, and finite if a process never stops
_READS = 32


class ProcessLog:
    """Output of the processes that are started with it, one after the other.

    On Windows it stays empty, and processes write to the streams of this one.

    Args:
        limit: Number of bytes that are kept.
    """

    def __init__(self, limit: int = LONGEST_LOG) -> None:
        self._limit = limit
        self._pipe: _Pipe | None = None

    def open(self) -> int | None:
        """Return the file descriptor for a new process, which the caller closes afterwards.

        Later output of earlier processes, or of their children, is not kept.
        """
        if sys.platform == "win32":  # There is no test whether a pipe contains data.
            return None
        reading, writing = os.pipe()
        self._pipe = _Pipe(reading, self._limit, self._pipe.take() if self._pipe else b"")
        threading.Thread(target=self._pipe.read_all, daemon=True).start()
        return writing

    def take(self) -> str:
        """Return the text since the last call, or the end of it."""
        if self._pipe is None:
            return ""
        data = self._pipe.take()
        text = data[-self._limit :].decode(errors="replace")
        if len(data) > self._limit:
            return f"(only the last {self._limit} bytes are kept)\n{text}"
        return text


class _Pipe:
    """Reading end of a pipe; a thread empties it, so that writers never wait."""

    def __init__(self, reading: int, limit: int, before: bytes) -> None:
        self._reading, self._limit = reading, limit
        self._data = bytearray(before)
        self._lock = threading.Lock()
        self._open = True

    def read_all(self) -> None:
        """Read until nobody can write any more."""
        while self._open:
            select.select([self._reading], [], [])
            with self._lock:
                self._read_what_is_there()
        os.close(self._reading)

    def take(self) -> bytes:
        """Return the data until now; one byte more than the limit if there was more."""
        with self._lock:
            self._read_what_is_there()
            data, self._data = bytes(self._data), bytearray()
        return data

    def _read_what_is_there(self) -> None:
        for _ in range(_READS):
            if not (self._open and select.select([self._reading], [], [], 0)[0]):
                return
            data = os.read(self._reading, self._limit)
            self._open = bool(data)
            self._data += data
            del self._data[: -self._limit - 1]
