"""Supports, obstacles and friction in the sketch of a problem."""

from collections.abc import Mapping, Sequence

import numpy as np
from matplotlib.lines import Line2D
from matplotlib.patches import Patch

from lacore.model.bodies.any_body import AnyBody, plane
from lacore.model.bodies.blocks.block_assembly import BlockAssembly
from lacore.model.bodies.touching import Edges
from lacore.model.conditions.loads import Fix
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.touching import in_plane, where_touching
from lacore.model.materials.friction import SMOOTH, STICK, Bonded, Coulomb, Friction, Tresca
from lacore.numerics.arrays import Floats
from lacore.pictures.axis import has_axis
from lacore.pictures.contact import GROUND
from lacore.pictures.sketch.sheet import Label, Sheet, middle, quantity, spaced
from lacore.reporting.units import Units

_HELD = "#3c3c3c"
_LAWS = ("#0072b2", "#e69f00", "#009e73", "#cc79a7", "#56b4e9", "#b15928")
_DEPTH, _GROUND = 7.0, 9.0  # points: hatches of supports and of obstacles
_BALL, _SPACING = 6.0, 14.0  # points: diameter and spacing of rollers
_FOOT = 13.0  # points: half of the ground under a node
_ASIDE = 0.3  # by a joint: place of its label
_NODES = {"clamped": "s", "xy": "^", "rotation": "D"}
_BESIDE = {"x": np.array([-1.0, 0.0]), "y": np.array([0.0, -1.0])}  # side of a node with its roller
_HOLDS = {
    "x": "$u_x = 0$",
    "y": "$u_y = 0$",
    "xy": "$u = 0$",
    "normal": "$u_n = 0$",
    "tangential": "$u_t = 0$",
    "rotation": r"$\omega = 0$",
    "clamped": r"$u = 0$, $\omega = 0$",
}
_AROUND_AXIS = {"x": "$u_r = 0$", "y": "$u_z = 0$"}


def draw_support(sheet: Sheet, support: Fix, body: AnyBody, gid: str) -> None:
    """Draw a support: hatches if fixed, rollers if the boundary may slide, squares if not."""
    names = _HOLDS | _AROUND_AXIS if has_axis([body]) else _HOLDS
    text = names[support.components]
    edges = plane(body).boundary(support.where, "Fix.where")[1]
    if body.pointwise:
        _draw_held_nodes(sheet, support, edges, text, gid)
    elif support.components == "xy":
        if not _holds_blocks(support, body):
            sheet.hatch(edges, _DEPTH, _HELD, gid)
            sheet.line(edges, _HELD, 1.2, gid)
            handle = Patch(facecolor="none", edgecolor=_HELD, hatch="//////", lw=0)
            sheet.handles[text] = handle
    else:
        axis = {"x": np.array([1.0, 0.0]), "y": np.array([0.0, 1.0])}.get(support.components)
        across = support.components == "normal" if axis is None else _across(edges, axis)
        _draw_rollers(sheet, edges, "o" if across else "s", text, gid)


def _holds_blocks(support: Fix, body: AnyBody) -> bool:
    """Return whether it holds whole blocks, which are drawn as held."""
    return isinstance(body, BlockAssembly) and not callable(support.where)


def _across(edges: Edges, axis: Floats) -> bool:
    """Return whether a direction points out of the boundary, rather than along it."""
    return bool(np.mean(np.abs(axis @ edges.normal)) > np.sqrt(0.5))


def _draw_rollers(sheet: Sheet, edges: Edges, marker: str, text: str, gid: str) -> None:
    places, normals = spaced(edges, _SPACING * sheet.point)
    _draw_balls(sheet, places, normals, edges, marker, text, gid)


def _draw_balls(
    sheet: Sheet,
    places: Floats,
    normals: Floats,
    edges: Edges,
    marker: str,
    text: str,
    gid: str,
) -> None:
    """Draw rollers at places, and their rail along edges."""
    x, y = places + 0.5 * _BALL * sheet.point * normals
    sheet.axes.scatter(
        x,
        y,
        s=(0.85 * _BALL) ** 2,
        marker=marker,
        facecolor="white",
        edgecolor=_HELD,
        linewidths=1.0,
        zorder=5,
        gid=gid,
    )
    sheet.line(edges, _HELD, 1.0, gid, away=_BALL + 0.6)
    sheet.take(sheet.band(edges, 0.0, _BALL + 1.0))
    sheet.handles[text] = Line2D(
        [], [], ls="none", marker=marker, mfc="white", mec=_HELD, ms=5.5, label=text
    )


def _draw_held_nodes(sheet: Sheet, support: Fix, nodes: Edges, text: str, gid: str) -> None:
    if support.components in _BESIDE:
        away = np.tile(_BESIDE[support.components][:, None], nodes.start.shape[1])
        half = 0.5 * _FOOT * sheet.point * np.stack([-away[1], away[0]])
        ground = Edges(nodes.start - half, nodes.start + half, away)
        _draw_balls(sheet, nodes.start, away, ground, "o", text, gid)
        return
    marker = _NODES[support.components]
    x, y = nodes.start
    sheet.axes.scatter(
        x, y, s=70, marker=marker, facecolor=GROUND, edgecolor="#222222", zorder=5, gid=gid
    )
    box = 6.0 * sheet.point * np.array([[-1, -1], [1, -1], [1, 1], [-1, 1]])
    sheet.take(nodes.start.T[:, None] + box)
    sheet.handles[text] = Line2D(
        [], [], ls="none", marker=marker, mfc=GROUND, mec="#222222", ms=7, label=text
    )


def law_text(law: Friction, units: Units) -> str:
    """Return a friction law, as mathtext."""
    if isinstance(law, Bonded):
        return "bond"
    if isinstance(law, Coulomb):
        told = rf"$\mu = {law.mu:.4g}$"
        if law.adhesion:
            told += ", $c_a = {}$ {}".format(*quantity(law.adhesion, "Pa", units))
        if law.tension:
            told += r", $t_n \geq -{}$ {}".format(*quantity(law.tension, "Pa", units))
        return told + (", associated" if law.associated else "")
    if law in (SMOOTH, STICK):
        return "smooth" if law == SMOOTH else "stick"
    return r"$|t_t| \leq {}$ {}".format(*quantity(law.limit, "Pa", units))


def law_colours(texts: Sequence[str]) -> dict[str, str]:
    """Return a colour for each law; a single one if there are too many laws."""
    distinct = list(dict.fromkeys(texts))
    if len(distinct) > len(_LAWS):
        return dict.fromkeys(distinct, _LAWS[0])
    return dict(zip(distinct, _LAWS, strict=False))


def joint_laws(body: BlockAssembly, units: Units) -> list[str]:
    """Return the law of each joint, as text."""
    joints = body.joints
    laws = []
    for coefficient, limit, dilatancy, tension in zip(
        joints.coefficient, joints.limit, joints.dilatancy, joints.tension, strict=True
    ):
        mu = float(coefficient + dilatancy)
        if mu > 0 or tension > 0:
            adhesion = float(limit + mu * tension)
            laws.append(law_text(Coulomb(mu, bool(dilatancy > 0), adhesion, float(tension)), units))
        else:
            laws.append(law_text(Tresca(float(limit)), units))
    return laws


def draw_joints(
    sheet: Sheet, body: BlockAssembly, colours: Mapping[str, str], label: bool, gid: str
) -> None:
    """Draw joints of an assembly, coloured by their friction; with `label` next to each."""
    laws, joints = joint_laws(body, sheet.units), body.joints
    many = len(colours) > len(set(colours.values()))
    if many:
        shown = f"joints: {len(set(laws))} friction laws"
        sheet.handles[shown] = Line2D([], [], color=_LAWS[0], lw=2.6)
    for text in dict.fromkeys(laws):
        chosen = np.array([law == text for law in laws])
        edges = Edges(*(array[:, chosen] for array in (joints.start, joints.end, joints.normal)))
        thin = chosen.size > 150
        sheet.line(edges, colours[text], 1.2 if thin else 2.6, gid)
        if label:
            for start, end, normal in zip(edges.start.T, edges.end.T, edges.normal.T, strict=True):
                place = _ASIDE * start + (1 - _ASIDE) * end  # Arrows are in the middle.
                sheet.labels.append(Label(text, place, 0.1 * normal, colours[text]))
        elif not many:
            shown = f"joints: {text}"
            sheet.handles[shown] = Line2D([], [], color=colours[text], lw=2.6)


def draw_interface(
    sheet: Sheet,
    interface: Interface,
    bodies: Mapping[str, AnyBody],
    colour: str,
    label: bool,
    gid: str,
) -> None:
    """Draw contact, coloured by its friction, and the obstacle, hatched."""
    segments = in_plane(where_touching(interface, bodies, "Interface"))
    edges = Edges(segments.start, segments.end, -segments.normal)
    if any(bodies[name].pointwise for name, _ in interface.sides):
        tangent = np.stack([-edges.normal[1], edges.normal[0]])
        half = _FOOT * sheet.point * tangent
        edges = Edges(edges.start - half, edges.end + half, edges.normal)
    if interface.obstacle is not None:
        sheet.hatch(edges, _GROUND, GROUND, gid)
        handle = Patch(facecolor="none", edgecolor=GROUND, hatch="//////", lw=0)
        sheet.handles["rigid obstacle"] = handle
    sheet.line(edges, colour, 3.0, gid)
    text = law_text(interface.law, sheet.units)
    if label:
        place, normal = middle(edges)
        behind = _GROUND * sheet.point if interface.obstacle is not None else 0.0
        sheet.labels.append(Label(text, place + behind * normal, normal, colour))
    else:
        shown = f"contact: {text}"
        sheet.handles[shown] = Line2D([], [], color=colour, lw=3, label=shown)
