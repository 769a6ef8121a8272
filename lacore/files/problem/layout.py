"""Tables as TOML that reads well: what is short on one line, one thing a table."""

from collections.abc import Mapping
from typing import Any

import tomlkit
from tomlkit.items import Item

_WIDTH = 90


def toml(document: Mapping[str, Any]) -> str:
    """A document of tables, lists, texts and numbers as TOML."""
    made = tomlkit.document()
    for name, own in document.items():
        made.add(name, _item(own))
    return tomlkit.dumps(made)


def _item(value: Any) -> Item:
    if isinstance(value, Mapping):
        return _table(value)
    if isinstance(value, list) and value and all(isinstance(own, Mapping) for own in value):
        tables = tomlkit.aot()
        for own in value:
            tables.append(_table(own))
        return tables
    found: Item = _inline(value)
    return found


def _table(value: Mapping[str, Any]) -> Item:
    """What is short first: a key after a sub-table would belong to that."""
    table, after = tomlkit.table(), {}
    for name, own in value.items():
        line = _inline(own)
        if isinstance(own, Mapping) and len(f"{name} = {line.as_string()}") > _WIDTH:
            after[name] = own
        else:
            table.add(name, line)
    for name, own in after.items():
        table.add(name, _table(own))
    return table


def _inline(value: Any) -> Any:
    if isinstance(value, Mapping):
        table = tomlkit.inline_table()
        for name, own in value.items():
            table.append(name, _inline(own))
        return table
    if isinstance(value, list):
        array = tomlkit.array()
        for own in value:
            array.append(_inline(own))
        return array
    return tomlkit.item(value)
