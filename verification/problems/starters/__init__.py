"""Problem files to begin with, and the schema of all of them."""

import tomllib
from importlib.resources import files

SCHEMA = "schema.json"


def titles() -> dict[str, str]:
    """What there is, by name."""
    names = sorted(file.name for file in files(__name__).iterdir() if file.name.endswith(".toml"))
    own = [name.removesuffix(".toml") for name in names]
    return {name: tomllib.loads(text(name))["title"] for name in own}


def text(name: str) -> str:
    """The file of a name."""
    return files(__name__).joinpath(f"{name}.toml").read_text(encoding="utf-8")


def schema() -> str:
    """The JSON schema of problem files."""
    return files("lacore.files.problem").joinpath(SCHEMA).read_text(encoding="utf-8")
