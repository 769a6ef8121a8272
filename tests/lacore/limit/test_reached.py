"""The mechanism of a soil that comes to where it is held is told, with the name of the boundary."""

import pytest

import lacore as la


def strip(width, depth, nx=16, ny=9, angle=20.0, bottom="xy"):
    """Half of a smooth footing, 2 m wide; Hill's mechanism at 20 degrees is 3.6 m by 1.2 m."""
    mesh = la.meshes.rectangle(
        x=(0, width), y=(-depth, 0), nx=nx, ny=ny, grade_x=(1.0, 5.0), grade_y=(0.0, 2.5)
    ).with_boundaries({"under": lambda x: (x[1] > -1e-9) & (x[0] < 1)})
    return la.Problem(
        {"soil": la.Body(mesh, la.MohrCoulomb(1.0, angle))},
        [la.RigidFooting("soil", "under", (0, -1), rough=False)],
        supports=[
            la.Fix("soil", "left", "x"),
            la.Fix("soil", "right"),
            la.Fix("soil", "bottom", bottom),
        ],
    )


@pytest.mark.parametrize(
    ("box", "names"),
    [
        ((4.0, 1.4), []),  # a tenth to spare
        ((4.0, 0.7), ["soil.bottom"]),
        ((2.5, 1.4), ["soil.right"]),
    ],
)
def test_a_box_that_is_too_small_is_named(box, names):
    message = la.solve(strip(*box)).message
    assert ("the mechanism reaches" in message) == bool(names)
    for side in ("soil.left", "soil.right", "soil.bottom"):
        assert (side in message) == (side in names)


def test_coarse_elements_beside_a_support_say_little():
    """Any motion ends in the last of them."""
    assert "reaches" not in la.solve(strip(4.0, 1.4, nx=5, ny=2)).message


def test_what_may_slide_along_a_support_is_no_far_boundary():
    assert "reaches" not in la.solve(strip(4.0, 0.7, bottom="y")).message


def test_a_metal_is_held_where_it_ends():
    assert "reaches" not in la.solve(strip(4.0, 0.7, angle=0.0)).message


def test_a_bracket_tells_it_too():
    tight = la.bracket(strip(4.0, 0.7, nx=8, ny=4), target_width=0.3)
    assert "the mechanism reaches soil.bottom" in tight.message
