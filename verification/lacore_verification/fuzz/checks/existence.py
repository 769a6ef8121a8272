"""Whether blocks on a deformable body have a load factor, where no result decides it.

A body without plastic flow lets blocks move in fewer ways: where that bounds the load, so does the
real one. A weaker one carries less: what it carries in equilibrium, the real one carries, too.
"""

from math import inf, isfinite

from lacore_verification.fuzz.checks.block_program import known_of
from lacore_verification.fuzz.drawn.copies import with_law
from lacore_verification.fuzz.drawn.draw import Rng
from lacore_verification.fuzz.drawn.recipe import Recipe, copied
from lacore_verification.fuzz.solving import answer

_WEAKER = (0.1, 0.01, 1e-3)


def carries(recipe: Recipe, rng: Rng) -> bool | None:
    """Return whether there is a Coulomb load factor; None if this does not determine it.

    As everywhere in `lacore fuzz`, a finite load with associated friction implies one with
    Coulomb's.
    """
    rigid = _of_blocks_only(recipe)
    if rigid is None:
        return None
    highest = known_of(rigid).highest
    if highest == -inf:
        return False
    if not isfinite(highest):
        return None
    for factor in _WEAKER:
        weaker = with_law(recipe, "associated")
        for body in weaker["bodies"].values():
            if "strength" in body:
                body["strength"] *= factor
        found = answer(weaker, rng)
        if found.solved and found.wrong is None:
            return True
    return None


def _of_blocks_only(recipe: Recipe) -> Recipe | None:
    """Return the recipe with its one continuum as a fixed block; None for other recipes."""
    kinds = {name: body["kind"] for name, body in recipe["bodies"].items()}
    if sorted(kinds.values()) != ["blocks", "continuum"] or len(recipe["interfaces"]) != 1:
        return None
    made = copied(recipe)
    (stone,) = (name for name, kind in kinds.items() if kind == "blocks")
    (soil,) = (name for name, kind in kinds.items() if kind == "continuum")
    mesh = made["bodies"].pop(soil)["mesh"]
    (left, right), (bottom, top) = mesh["x"], mesh["y"]
    body = made["bodies"][stone]
    ground = [[left, bottom], [right, bottom], [right, top], [left, top]]
    law = made["interfaces"].pop()["friction"]
    body["joints"] += [["ground", name, law] for name in body["polygons"]]
    body["polygons"] = {"ground": ground, **body["polygons"]}
    made["supports"] = [{"body": stone, "where": "ground"}]
    for key in ("reference", "dead"):
        made[key] = [load for load in made[key] if load["body"] == stone]
        for load in made[key]:
            if load["load"] == "BodyForce" and "where" not in load:
                load["where"] = None
    return made
