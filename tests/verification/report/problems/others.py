"""Problem files of what no starter has: drawings, fills, sections, adhesion, hardening."""

import lacore as la
from tests.lacore.model.bodies.drawings import geojson

_FACADE = """\
[bodies.front]
kind = "drawing"
file = "facade.geojson"
unit = "m"
snap = "1 mm"
layers.stone = { friction = 0.65, density = "2400 kg/m3" }
layers.ground = { friction = { mu = 0.65, adhesion = "1 kPa", tension = 100 }, density = 0 }
joints = [{ between = ["stone", "ground"], friction = 0.5 }]
[[supports]]
body = "front"
where = { layer = "ground" }
[[dead_loads]]
load = "weight"
body = "front"
[[reference_loads]]
load = "weight"
body = "front"
direction = [1, 0]
"""
_VAULT = """\
[bodies.vault]
kind = "arch"
voussoirs = 9
inner_radius = 2
thickness = 0.4
friction = { angle = "35 deg", adhesion = "2 kPa" }
[[supports]]
body = "vault"
where = ["left", "right"]
[[dead_loads]]
load = "weight"
body = "vault"
unit_weight = "20 kN/m3"
[[dead_loads]]
load = "fill"
body = "vault"
unit_weight = "18 kN/m3"
level = 2.8
lateral = 0.3
[[reference_loads]]
load = "fill"
body = "vault"
unit_weight = "1 kN/m3"
level = 2.8
surcharge = "1 kPa"
where = ["1", "2", "3", "4"]
"""
_FRAME = """\
[bodies.portal]
kind = "frame"
nodes = { A = [0, 0], B = [0, 4], C = [6, 4], D = [6, 0], E = [9, 0] }
members = { left = ["A", "B"], beam = ["B", "C"], right = ["C", "D"], stay = ["C", "E"] }
sections.left = { name = "IPE 300", yield_stress = "235 MPa", layers = 4, polygon = "outer" }
sections.beam = { height = 0.3, width = 0.2, web = "8 mm", flange = 0.01, yield_stress = 3e8 }
sections.right = { corners = [[-9e5, 0], [0, 2e5], [9e5, 0]], name = "own" }
sections.stay = { tension = "50 kN", compression = 0 }
[[supports]]
body = "portal"
where = ["A", "D", "E"]
[[reference_loads]]
load = "point-force"
body = "portal"
at = "B"
vector = ["10 kN", 0]
"""
_BILLET = """\
[bodies.billet]
kind = "continuum"
mesh = { shape = "rectangle", x = [0, "60 mm"], y = [0, "20 mm"], nx = 3, ny = 1 }
[bodies.billet.material]
criterion = "von-mises"
hardening = { law = "voce", yield_stress = "200 MPa", saturation = "300 MPa", rate = 8 }
[[supports]]
body = "billet"
where = "left"
components = "x"
[[interfaces]]
slave = { body = "billet", where = "top" }
master = { point = [0, "20 mm"], normal = [0, -1] }
friction = { mu = 0.2, adhesion = "4 MPa", tension = "2 MPa", associated = true }
[[reference_loads]]
load = "rigid-footing"
body = "billet"
where = "bottom"
direction = [0, 1]
pressure = "1 MPa"
"""
TEXTS = {"facade": _FACADE, "vault": _VAULT, "sections": _FRAME, "hardening": _BILLET}


def draw(folder):
    """What a file names."""
    blocks = la.masonry.running_bond(la.masonry.regular_bond(3, 4), 0.65)
    layers = (("ground" if name == "base" else "stone") for name in blocks.names)
    geojson(folder / "facade.geojson", list(zip(layers, blocks.polygons.values(), strict=True)))
