"""Domes, arches, vaults, walls, corners, stairs: volumes, joints and areas by hand."""

from itertools import pairwise

import numpy as np
import pytest
import shapely

import lacore as la

ROUND_OFF = 1e-12  # of sums of a few hundred products of order one


def shared(assembly, one, other):
    """The area that two blocks share, m^2."""
    numbers = {assembly.names.index(one), assembly.names.index(other)}
    joints = assembly.joints
    own = [{a, b} == numbers for a, b in zip(joints.master, joints.slave, strict=True)]
    return float(joints.area[own].sum())


@pytest.mark.parametrize("bond", [False, True])
@pytest.mark.parametrize("base", [False, True])
def test_a_dome_is_made_of_pyramids_about_its_centre(bond, base):
    m, rings, radius, thick, oculus = 6, 3, 2.0, 0.3, 0.4
    dome = la.masonry3d.dome(m, rings, radius, thick, oculus, 0.5, bond=bond, base=base)
    assert len(dome.names) == m * (rings + base)
    sectors = m * (2 if bond else 1)
    beds = np.linspace(np.pi / 2, oculus, rings + 1)
    beds = np.append(2 * beds[0] - beds[1], beds) if base else beds
    volume = 0.0
    for low, high in pairwise(beds):
        # A ring of trapezia on a sphere of radius 1, seen from its centre: two thirds of the
        # determinants of half of each.
        corners = [
            (np.sin(t) * np.cos(a), np.sin(t) * np.sin(a), np.cos(t))
            for t, a in (
                (low, 0),
                (low, 2 * np.pi / sectors),
                (high, 2 * np.pi / sectors),
                (high, 0),
            )
        ]
        a, b, c, d = map(np.array, corners)
        volume += sectors * abs(np.linalg.det([a, b, c]) + np.linalg.det([a, c, d])) / 6
    shells = (radius + thick / 2) ** 3 - (radius - thick / 2) ** 3
    assert dome.volume.sum() == pytest.approx(shells * volume, rel=ROUND_OFF)
    # A head joint a block, and the facets of each bed; that of the springing is plane.
    assert dome.joints.count == (rings + base) * m + (rings - 1) * sectors + base * m


def test_head_joints_of_a_bonded_dome_are_shifted():
    dome = la.masonry3d.dome(6, 2, 1.0, 0.2, 0.5, 0.5, bond=True)
    assert shared(dome, "r1m1", "r2m1") == pytest.approx(shared(dome, "r1m2", "r2m1"), rel=1e-9)
    assert shared(dome, "r1m1", "r2m1") > 0
    assert shared(dome, "r1m1", "r2m2") == 0


def test_arches_are_those_of_the_plane_made_deep():
    plane = la.masonry.arch(9, 0.85, 0.3, 0.6)
    for slices in (1, 3):
        deep = la.masonry3d.arch(9, 0.85, 0.3, 2.0, 0.6, slices=slices)
        assert deep.volume.sum() == pytest.approx(2 * plane.area.sum(), rel=ROUND_OFF)
        beds = deep.joints.area[np.abs(deep.joints.normal[1]) < 0.5]
        assert beds.sum() == pytest.approx(2 * plane.joints.length.sum(), rel=1e-9)
        assert deep.joints.count == slices * plane.joints.count + (slices - 1) * len(plane.names)


def test_laws_of_single_joints_are_kept_by_slices():
    plane = la.masonry.stack([(1, 1), (1, 1)], 0.5, {("1", "2"): 0.2})
    assert set(la.masonry3d.extruded(plane, 1.0).joint_friction) == {("1", "2")}
    deep = la.masonry3d.extruded(plane, 1.0, slices=2)
    assert set(deep.joint_friction) == {("1/1", "2/1"), ("1/2", "2/2")}


@pytest.mark.parametrize("bond", [False, True])
def test_a_barrel_is_as_long_as_it_is(bond):
    vault = la.masonry3d.barrel_vault(5, 3, 1.0, 0.2, 3.0, 0.6, bond=bond)
    plane = la.masonry.arch(5, 1.0, 0.2, 0.6)
    assert vault.volume.sum() == pytest.approx(3 * plane.area.sum(), rel=ROUND_OFF)
    assert len(vault.names) == 2 + 3 * 3 + 2 * (4 if bond else 3)
    if bond:
        assert shared(vault, "v1c1", "v2c1") == pytest.approx(0.5 * 0.2, rel=1e-9)
        assert shared(vault, "v1c1", "v2c2") == pytest.approx(0.5 * 0.2, rel=1e-9)


@pytest.mark.parametrize("voussoirs", [3, 8, 9])
def test_webs_of_a_cross_vault_meet_in_the_groins(voussoirs):
    vault = la.masonry3d.cross_vault(voussoirs, 0.9, 0.2, 1.2, 0.6, base=False)
    assert len(vault.names) == 4 * voussoirs
    beds, groins = 4 * (voussoirs - 1), 4 * ((voussoirs + 1) // 2)
    assert vault.joints.count == beds + groins
    turned = np.abs(vault.joints.normal[:2]).min(axis=0) > 0.7
    assert np.count_nonzero(turned) == groins
    # The groin cuts the section of the web at 45 degrees: its areas are those times sqrt 2.
    section = la.masonry.arch(voussoirs, 0.9, 0.2, 0.6)
    webs = [n for n, name in enumerate(section.names) if name not in ("left", "right")]
    assert vault.joints.area[turned].sum() == pytest.approx(
        2 * np.sqrt(2) * section.area[webs].sum(), rel=1e-9
    )
    # Each web is its section times its length less what the diagonals cut off: |y| on average.
    ends = section.polygons
    cut = sum(_first_moment(ends[section.names[n]]) for n in webs)
    assert vault.volume.sum() == pytest.approx(4 * (1.2 * section.area[webs].sum() - cut), rel=1e-9)


def _first_moment(polygon):
    """The integral of |x| over a polygon that lies on one side, or is symmetric about x = 0."""
    whole = shapely.Polygon(polygon)
    halves = [whole.intersection(shapely.box(*own)) for own in ((-9, 0, 0, 9), (0, 0, 9, 9))]
    return sum(half.area * abs(half.centroid.x) for half in halves if half.area > 1e-12)


def test_a_wall_is_that_of_the_plane():
    rows = la.masonry.regular_bond(3, 2)
    plane = la.masonry.running_bond(rows, 0.6, (0.4, 0.2))
    wall = la.masonry3d.wall(rows, 0.6, (0.4, 0.3, 0.2))
    assert wall.names == plane.names
    assert wall.joints.area.sum() == pytest.approx(0.3 * plane.joints.length.sum(), rel=1e-9)


def test_a_corner_is_in_bond():
    corner = la.masonry3d.corner((3, 2), 2, 0.6, (0.4, 0.2, 0.1))
    volume = 0.2 * (3 * 0.4 + 2 * 0.4 - 0.2) * 0.1
    assert corner.volume.sum() == pytest.approx(3 * volume, rel=ROUND_OFF)  # with the base
    assert shared(corner, "c1x1", "c2y1") == pytest.approx(0.2 * 0.2, rel=1e-9)
    assert shared(corner, "c1x1", "c2x1") == pytest.approx(0.2 * 0.2, rel=1e-9)
    assert shared(corner, "c1x1", "c1y1") == pytest.approx(0.2 * 0.1, rel=1e-9)
    assert shared(corner, "base", "c1x2") == pytest.approx(0.4 * 0.2, rel=1e-9)


def test_stairs_rest_on_each_other_and_in_the_wall():
    stairs = la.masonry3d.stairs(3, 0.28, 0.17, 1.2, 0.03, 0.6, bearing=0.2)
    assert shared(stairs, "step1", "step2") == pytest.approx(0.03 * 1.4, rel=1e-9)
    assert shared(stairs, "step2", "below2") == pytest.approx(0.28 * 0.2, rel=1e-9)
    assert shared(stairs, "step2", "above2") == pytest.approx(0.28 * 0.2, rel=1e-9)
    assert shared(stairs, "base", "step1") == pytest.approx(0.31 * 1.4, rel=1e-9)
    free = la.masonry3d.stairs(3, 0.28, 0.17, 1.2, 0.03, 0.6)
    assert free.names == ("base", "step1", "step2", "step3", "landing")


M = la.masonry3d


@pytest.mark.parametrize(
    ("build", "field"),
    [
        (lambda: M.dome(2, 3, 1.0, 0.1, 0.2, 0.5), "dome.meridians"),
        (lambda: M.dome(6, 0, 1.0, 0.1, 0.2, 0.5), "dome.rings"),
        (lambda: M.dome(6, 3, -1.0, 0.1, 0.2, 0.5), "dome.radius"),
        (lambda: M.dome(6, 3, 1.0, 2.0, 0.2, 0.5), "dome.thickness"),
        (lambda: M.dome(6, 3, 1.0, 0.1, 0.0, 0.5), "dome.oculus"),
        (lambda: M.dome(6, 3, 1.0, 0.1, 1.6, 0.5), "dome.oculus"),
        (lambda: M.dome(6, 3, 1.0, 0.1, 0.2, 0.5, springing=3.0), "dome.springing"),
        (lambda: M.dome(6, 3, 1.0, 0.1, 0.2, -0.5), "BlockAssembly3D.friction"),
        (lambda: M.arch(9, 1.0, 0.1, 0.0, 0.5), "extruded.depth"),
        (lambda: M.arch(9, 1.0, 0.1, 1.0, 0.5, slices=0), "extruded.slices"),
        (lambda: M.barrel_vault(9, 0, 1.0, 0.1, 1.0, 0.5), "barrel_vault.courses"),
        (lambda: M.cross_vault(2, 0.9, 0.2, 1.2, 0.5), "cross_vault.voussoirs"),
        (lambda: M.cross_vault(9, 0.9, 0.2, 1.1, 0.5), "cross_vault.half_side"),
        (lambda: M.wall([[1, 1]], 0.5, (0.4, 0.2)), "wall.block"),
        (lambda: M.corner((3, 2), 2, 0.5, (0.2, 0.2, 0.1)), "corner.block"),
        (lambda: M.corner((3,), 2, 0.5), "corner.blocks"),
        (lambda: M.corner((3, 0), 2, 0.5), "corner.blocks"),
        (lambda: M.stairs(3, 0.28, 0.17, 1.2, 0.28, 0.6), "stairs.overlap"),
        (lambda: M.stairs(3, 0.28, 0.17, 1.2, 0.03, 0.6, -1.0), "stairs.bearing"),
    ],
)
def test_what_cannot_be_built_is_refused_by_field(build, field):
    with pytest.raises(la.InputError) as refused:
        build()
    assert refused.value.field == field
