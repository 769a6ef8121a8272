"""Starter files of problems, and the JSON schema of problem files."""

import tomllib
from importlib.resources import files

SCHEMA = "schema.json"


def titles() -> dict[str, str]:
    """Return the titles of the starter files by name."""
    names = sorted(file.name for file in files(__name__).iterdir() if file.name.endswith(".toml"))
    own = [name.removesuffix(".toml") for name in names]
    return {name: tomllib.loads(text(name))["title"] for name in own}


def text(name: str) -> str:
    """Return the text of a starter file."""
    return files(__name__).joinpath(f"{name}.toml").read_text(encoding="utf-8")


def schema() -> str:
    """Return the JSON schema of problem files."""
    return files("lacore.files.problem").joinpath(SCHEMA).read_text(encoding="utf-8")
