"""Writes the JSON schema of problem files, ``lacore/files/problem/schema.json``."""

import json
from pathlib import Path

from lacore.files.problem.schema.document import ProblemFile

FILE = Path(__file__).parents[1] / "lacore" / "files" / "problem" / "schema.json"


def schema() -> str:
    """The schema as text."""
    made = ProblemFile.model_json_schema(by_alias=True)
    head = {"$schema": "https://json-schema.org/draft/2020-12/schema"}
    return json.dumps(head | made, indent=1, ensure_ascii=False) + "\n"


if __name__ == "__main__":
    FILE.write_text(schema(), encoding="utf-8")
