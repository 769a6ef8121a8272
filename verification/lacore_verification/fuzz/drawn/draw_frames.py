"""Random frames: bays and storeys of unequal members on all kinds of supports."""

from typing import Any

from lacore_verification.fuzz.drawn.draw import Rng, chosen, number, short, vector
from lacore_verification.fuzz.drawn.recipe import Recipe


def frames(rng: Rng) -> Recipe:
    """Return a frame of one or two bays and storeys under forces at nodes and along members.

    Some are regular: all bays, storeys, columns and beams are equal.
    """
    bays, storeys = int(rng.integers(1, 3)), int(rng.integers(1, 3))
    # Regular frames have many mechanisms and stresses at one load factor.
    regular = bool(rng.random() < 0.3)
    nodes = _grid(rng, bays, storeys, regular)
    members = _members(bays, storeys)
    if rng.random() < 0.2:
        members["brace"] = ["n00", f"n1{storeys}"]
    moments = {name: number(rng, 0.5, 3.0) for name in members}
    if regular:
        alike = {"c": number(rng, 0.5, 3.0), "b": number(rng, 0.5, 3.0)}
        moments = {name: alike[name[0]] for name in members}
    frame = {"kind": "frame", "nodes": nodes, "members": members, "plastic_moment": moments}
    feet = [f"n{i}0" for i in range(bays + 1)]
    upper = [name for name in nodes if name not in feet]
    supports, interfaces, dead = _held(rng, feet, upper)
    reference = [_force(rng, nodes, members, upper) for _ in range(int(rng.integers(1, 3)))]
    if rng.random() < 0.3:
        dead.append(_pressed_beam(rng, members))
    return {
        "bodies": {"frame": frame},
        "reference": reference,
        "dead": dead,
        "supports": supports,
        "interfaces": interfaces,
    }


def sections(rng: Rng) -> Recipe:
    """Return a frame of rectangular sections with interaction of axial force and moment."""
    recipe = frames(rng)
    frame = recipe["bodies"]["frame"]
    moments = frame.pop("plastic_moment")
    stress = number(rng, 0.5, 5.0)
    heights = {name: number(rng, 0.2, 1.5) for name in moments}
    frame["sections"] = {
        name: [short(4 * moment / (stress * heights[name] ** 2)), heights[name], stress]
        for name, moment in moments.items()
    }
    frame["polygon"] = "inner"
    upper = [name for name in frame["nodes"] if name[2] != "0"]
    feet = [name for name in frame["nodes"] if name[2] == "0"]
    for load in recipe["reference"]:
        if not isinstance(load["at"], str):
            load.update(at=chosen(rng, upper))
    recipe["dead"] = [load for load in recipe["dead"] if load["load"] == "PointForce"]
    if recipe["interfaces"]:
        recipe["interfaces"] = []
        recipe["supports"] = [
            {"body": "frame", "where": foot, "components": "clamped"} for foot in feet
        ]
    return recipe


def _grid(rng: Rng, bays: int, storeys: int, regular: bool) -> dict[str, list[float]]:
    """Return the nodes of bays and storeys; some have an inclined first column."""
    wide, high = number(rng, 1.0, 4.0), number(rng, 1.0, 3.0)
    x, y = [0.0], [0.0]
    for _ in range(bays):
        x.append(round(x[-1] + (wide if regular else number(rng, 1.0, 4.0)), 6))
    for _ in range(storeys):
        y.append(round(y[-1] + (high if regular else number(rng, 1.0, 3.0)), 6))
    skew = number(rng, -0.5, 0.5) if not regular and rng.random() < 0.4 else 0.0
    return {
        f"n{i}{j}": [round(px + (skew * py if i == 0 else 0.0), 6), py]
        for i, px in enumerate(x)
        for j, py in enumerate(y)
    }


def _members(bays: int, storeys: int) -> dict[str, list[str]]:
    """Return columns and beams between the nodes."""
    return {
        f"c{i}{j}": [f"n{i}{j}", f"n{i}{j + 1}"] for i in range(bays + 1) for j in range(storeys)
    } | {
        f"b{i}{j}": [f"n{i}{j}", f"n{i + 1}{j}"] for i in range(bays) for j in range(1, storeys + 1)
    }


def _pressed_beam(rng: Rng, members: dict[str, list[str]]) -> dict[str, Any]:
    """A downward traction along a beam."""
    beams = [name for name in members if name[0] == "b" and name != "brace"]
    where = chosen(rng, beams)
    pressure = [0.0, -number(rng, 0.05, 0.3)]
    return {"load": "Traction", "body": "frame", "where": where, "vector": pressure}


def _held(
    rng: Rng, feet: list[str], upper: list[str]
) -> tuple[list[dict[str, Any]], list[dict[str, Any]], list[dict[str, Any]]]:
    """Return supports or frictional contact of the feet, and dead loads that press them down."""
    supports: list[dict[str, Any]] = []
    interfaces: list[dict[str, Any]] = []
    dead: list[dict[str, Any]] = []
    if rng.random() < 0.6:
        supports = [
            {
                "body": "frame",
                "where": foot,
                "components": chosen(rng, ("clamped", "xy", "xy", "y")),
            }
            for foot in feet
        ]
        supports[0]["components"] = chosen(rng, ("clamped", "xy"))
    else:
        mu: Any = number(rng, 0.1, 1.0)
        if rng.random() < 0.3:
            mu = chosen(rng, ({"associated": number(rng, 0.1, 0.8)}, {"tresca": 0.3}, "stick"))
        supports, interfaces = [], [_feet(feet, mu)]
        dead = [
            {
                "load": "PointForce",
                "body": "frame",
                "at": name,
                "vector": [0.0, -number(rng, 0.5, 3)],
            }
            for name in upper
        ]
    return supports, interfaces, dead


def _force(
    rng: Rng, nodes: dict[str, list[float]], members: dict[str, list[str]], upper: list[str]
) -> dict[str, Any]:
    """Return a force at a node, or a downward one on a beam."""
    if rng.random() < 0.6:
        at: Any = chosen(rng, upper)
        return {"load": "PointForce", "body": "frame", "at": at, "vector": vector(rng)}
    ends = members[chosen(rng, [m for m in members if m[0] == "b"])]
    share = number(rng, 0.3, 0.7)
    one, other = (nodes[end] for end in ends)
    at = [round(a + share * (b - a), 9) for a, b in zip(one, other, strict=True)]
    return {"load": "PointForce", "body": "frame", "at": at, "vector": [0.0, -1.0]}


def _feet(feet: list[str], friction: Any) -> dict[str, Any]:
    return {
        "slave": ["frame", feet],
        "master": {"point": [0.0, 0.0], "normal": [0.0, 1.0]},
        "friction": friction,
    }
