"""What supports hold of the nodes of a frame."""

COMPONENTS = {
    "x": (True, False, False),
    "y": (False, True, False),
    "xy": (True, True, False),
    "rotation": (False, False, True),
    "clamped": (True, True, True),
}
"""Which of u_x, u_y and the rotation."""
