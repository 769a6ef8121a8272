"""Assembly of the blocks of layers, with the friction of joints within and between layers."""

from collections.abc import Mapping
from dataclasses import replace
from itertools import combinations_with_replacement

from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.blocks.drawings.drawn import Layer
from lacore.model.materials.friction import Friction, friction_law
from lacore.numerics.arrays import Floats
from lacore.reporting.errors import InputError, require_known
from lacore.reporting.text import Term, text

LayerFriction = Mapping[tuple[str, str], float | Friction]
"""Laws of joints between two layers of a drawing, by their names."""


def assembled(
    polygons: Mapping[str, Floats],
    layer: Mapping[str, str],
    layers: Mapping[str, Layer],
    between: LayerFriction,
) -> BlockAssembly:
    """Return blocks whose joints have the friction of their layer, or the weaker one of two.

    Args:
        polygons: polygons by name.
        layer: layer of each block.
        layers: materials of the layers.
        between: other laws, by pairs of layers in either order.

    Raises:
        InputError: unknown layers in `between`, pairs given twice, or adjacent layers whose laws
            cross.
    """
    given = _given(between, layers)
    first = friction_law(next(iter(layers.values())).friction, "Layer.friction")
    blocks = BlockAssembly(polygons, first)
    joints = blocks.joints
    met = {
        (blocks.names[one], blocks.names[other])
        for one, other in zip(joints.master.tolist(), joints.slave.tolist(), strict=True)
    }
    kinds = {frozenset((layer[one], layer[other])) for one, other in met}
    laws = {}
    for pair in combinations_with_replacement(layers, 2):
        kind = frozenset(pair)
        if kind in kinds:
            laws[kind] = given[kind] if kind in given else _weaker(pair, layers)
    special = {
        (one, other): laws[frozenset((layer[one], layer[other]))]
        for one, other in sorted(met)
        if laws[frozenset((layer[one], layer[other]))] != first
    }
    return replace(blocks, joint_friction=special) if special else blocks


def _given(between: LayerFriction, layers: Mapping[str, Layer]) -> dict[frozenset[str], Friction]:
    field = "joint_friction"
    if not isinstance(between, Mapping):
        raise InputError(field, between, "no mapping", "give {('stone', 'brick'): friction}")
    found: dict[frozenset[str], Friction] = {}
    for pair, law in between.items():
        if not (isinstance(pair, tuple) and len(pair) == 2):
            raise InputError(field, pair, "not two layers", "give {('stone', 'brick'): friction}")
        for name in pair:
            require_known(field, name, layers)
        if frozenset(pair) in found:
            raise InputError(field, pair, "these layers are given twice", "give one order only")
        found[frozenset(pair)] = friction_law(law, f"{field}[{pair!r}]")
    return found


def _weaker(pair: tuple[str, str], layers: Mapping[str, Layer]) -> Friction:
    """Return the law with the smaller strength at any pressure."""
    one, other = (friction_law(layers[name].friction, "Layer.friction") for name in pair)
    for law, against in ((one, other), (other, one)):
        if law.terms().within(against.terms()):
            return law
    raise InputError(
        "joint_friction",
        None,
        f"the layers {pair[0]!r} and {pair[1]!r} meet, and neither of their laws is the weaker one",
        text(
            "give {}",
            Term(
                f"joint_friction={{{pair!r}: friction}}",
                f'joints: between = ["{pair[0]}", "{pair[1]}"]',
            ),
        ),
    )
