"""Inject errors into a copy of the tree and report which of them the fast tests do not notice.

Each error is injected alone, and the fast tests of its package run until the first failure: of the
test files that run the changed statement, and first the tests that run it, the quickest first.
Tests that do not end count as a failure. An error is reported as FAILING if its tests fail without
it.
Finished errors are recorded, and a second run continues with the others; an error that was not
noticed runs again when tests of its package have changed.
"""

import argparse
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from pathlib import Path

from tests.mutants.mutants import Mutant, generated, known
from tests.mutants.order import Ran, ordered

SAMPLE = 200  # errors that are generated, unless another number is given
ROOT = Path(__file__).parents[2]
_COPIED_NOT = shutil.ignore_patterns(
    *(".git", ".venv", "reports", "build", "dist", "__pycache__", ".*_cache", ".hypothesis")
)
_LEAST_LIMIT, _SLOWER = 60.0, 4.0  # s, and times what the tests take without an error
_FAILED, _INTERRUPTED = 1, 2  # exit codes of pytest: of a test, and of an import
NOTICED, ENDLESS, MISSED, FAILING = "noticed", "time limit", "NOT NOTICED", "FAILING"


@dataclass
class Copy:
    """A copy of the tree, in which one file at a time has an error."""

    root: Path
    known: dict[tuple[str, ...], list[Ran] | None] = field(default_factory=dict)
    writes: int = 0

    def outcome(self, mutant: Mutant) -> tuple[str, float]:
        """Return what the tests make of an error, and the time that they take, s."""
        without = self._without_error(mutant.tests)
        if without is None:
            return FAILING, 0.0
        original = (self.root / mutant.path).read_bytes()
        order = self.root.with_name("order.json")
        chosen = ordered(without, mutant.path.as_posix(), original, mutant.source)
        order.write_text(json.dumps([ran.test for ran in chosen]), encoding="utf-8")
        limit = max(_LEAST_LIMIT, _SLOWER * sum(ran.seconds for ran in chosen))
        files = dict.fromkeys(ran.file for ran in chosen)
        self._write(mutant.path, mutant.source)
        try:
            code, seconds = self._run((f"--order={order}", *files), limit)
        finally:
            self._write(mutant.path, original)
        if code not in (0, _FAILED, _INTERRUPTED, None):
            raise SystemExit(f"pytest ended with exit code {code} for {mutant}")
        return {0: MISSED, None: ENDLESS}.get(code, NOTICED), seconds

    def _without_error(self, tests: tuple[str, ...]) -> list[Ran] | None:
        """Return what tests run without an error; None where they fail, and prove nothing."""
        if tests not in self.known:
            rows = self.root.with_name("lines.json")
            code, _ = self._run((f"--lines-to={rows}", *tests), None)
            self.known[tests] = None
            if code == 0:
                found = json.loads(rows.read_text(encoding="utf-8"))
                self.known[tests] = [Ran.of_row(row) for row in found]
        return self.known[tests]

    def _write(self, path: Path, source: bytes) -> None:
        """Write a file with a time of its own: bytecode is recognised by time and size."""
        target, self.writes = self.root / path, self.writes + 1
        target.write_bytes(source)
        moment = time.time() + 10 * self.writes
        os.utime(target, (moment, moment))

    def _run(self, arguments: tuple[str, ...], limit: float | None) -> tuple[int | None, float]:
        """Return the exit code, None at the time limit, and the time, s."""
        paths = [self.root, *{own.parents[1] for own in self.root.glob("*/lacore*/__init__.py")}]
        places = os.pathsep.join(map(str, paths))
        environment = os.environ | {"PYTHONPATH": places, "OMP_NUM_THREADS": "1"}
        environment.pop("PYTHONDONTWRITEBYTECODE", None)
        plugins = ["-p", "no:cacheprovider", "-p", "tests.mutants.coverage"]
        command = [sys.executable, "-m", "pytest", "-x", "-q", *plugins, *arguments]
        begin = time.perf_counter()
        with subprocess.Popen(
            command,
            cwd=self.root,
            env=environment,
            stdout=subprocess.DEVNULL,
            stderr=subprocess.DEVNULL,
            start_new_session=True,
        ) as process:
            try:
                code = process.wait(limit)
            except subprocess.TimeoutExpired:
                code = None
            finally:
                if process.poll() is None:
                    os.killpg(process.pid, signal.SIGKILL)
        return code, time.perf_counter() - begin


def digest(root: Path, tests: Sequence[str]) -> str:
    """Return a digest of test files of a tree and of the modules next to them."""
    places = [root / name for name in tests]
    every = [file for own in places for file in sorted([own, *own.rglob("*.py")]) if file.is_file()]
    return hashlib.sha256(b"\0".join(file.read_bytes() for file in every)).hexdigest()[:16]


def finished(records: Path) -> dict[str, dict[str, str]]:
    """Return the last record of each error."""
    if not records.exists():
        return {}
    rows = [json.loads(line) for line in records.read_text(encoding="utf-8").splitlines()]
    return {row["key"]: row for row in rows}


def judged(mutants: Sequence[Mutant], records: Path) -> Iterator[tuple[Mutant, str, float]]:
    """Yield each error, what tests make of it, and the time, s: 0 if it is already known."""
    known_rows = finished(records)
    records.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder, records.open("a", encoding="utf-8") as file:
        copy = Copy(Path(folder, "tree"))
        shutil.copytree(ROOT, copy.root, ignore=_COPIED_NOT)
        for mutant in mutants:
            row, tests = known_rows.get(mutant.key), digest(copy.root, mutant.tests)
            if row is not None and (row["outcome"] != MISSED or row["tests"] == tests):
                yield mutant, row["outcome"], 0.0
                continue
            found, seconds = copy.outcome(mutant)
            row = {"key": mutant.key, "outcome": found, "tests": tests, "error": str(mutant)}
            if found != FAILING:
                file.write(json.dumps(row) + "\n")
                file.flush()
            yield mutant, found, seconds


def main() -> int:
    """Run the command; the exit code is 1 if an error is not noticed."""
    parser = argparse.ArgumentParser(prog="make mutants", description=__doc__)
    parser.add_argument(
        "--sample", type=int, default=SAMPLE, help=f"number of generated errors ({SAMPLE})"
    )
    parser.add_argument("--seed", type=int, default=0, help="seed of the random choice (0)")
    parser.add_argument("--only", default="", help="part of the path of files with errors")
    parser.add_argument("--records", type=Path, default=ROOT / "reports" / "mutants.jsonl")
    parser.add_argument("--list", action="store_true", help="print the errors and run nothing")
    given = parser.parse_args()
    mutants = [own for own in known(ROOT) if given.only in str(own.path)]
    listed = {own.key for own in mutants}
    drawn = generated(ROOT, given.sample, given.seed, given.only)
    mutants += [own for own in drawn if own.key not in listed]
    if given.list:
        print(*mutants, sep="\n")
        return 0
    missed, equivalent = [], {own.key for own in mutants if own.equivalent}
    possible = [own for own in mutants if own.key not in equivalent]
    for mutant, found, seconds in judged(possible, given.records):
        print(f"{found:11}  {seconds:5.0f} s  {mutant}", flush=True)
        missed += [mutant] if found in (MISSED, FAILING) else []
    print(f"{len(possible) - len(missed)} of {len(possible)} errors are noticed;", end=" ")
    print(f"{len(mutants) - len(possible)} cannot be noticed and were not run")
    print(*(f"not noticed: {mutant}" for mutant in missed), sep="\n")
    return 1 if missed else 0


if __name__ == "__main__":
    sys.exit(main())
