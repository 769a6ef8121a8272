"""Names that appear in several messages, as written in Python and in problem files."""

from lacore.reporting.text import Term

SMOOTH = Term("lacore.SMOOTH", '"smooth"')
STICK = Term("lacore.STICK", '"stick"')
BOND = Term("lacore.BOND", '"bond"')
COULOMB = Term("lacore.Coulomb(mu)", "{ mu = ... }")
ASSOCIATED = Term("Coulomb(mu, associated=True)", "{ mu = ..., associated = true }")

CONTINUUM = Term("lacore.Body", 'body of kind "continuum"')
RIGID_BLOCK = Term("lacore.RigidBlock", 'body of kind "block"')
TRIANGLES = Term("skfem.MeshTri", "mesh of triangles")
LAYERED = Term("lacore.model.meshes.layered", 'shape = "layered"')
OF_PLACE = Term("a function of coordinates (2, n)", "numbers that vary with the place")

SUPPORT = Term("Fix", "support")
APPROACHING = Term("`approaching` of lacore.sequential", "[[path.approaching]]")
REFERENCE_LOADS = Term("Problem.reference_loads", "reference_loads")
PRESSURE = Term("Pressure", 'load = "pressure"')
POINT_FORCE = Term("PointForce", 'load = "point-force"')
TRACTION = Term("Traction", 'load = "traction"')
FOOTING = Term("RigidFooting", 'load = "rigid-footing"')
OBSTACLE = Term("RigidObstacle", "plane obstacle")
PLANE = Term(
    "RigidObstacle(point=(x, y), normal=(nx, ny))", "{ point = [x, y], normal = [nx, ny] }"
)
POINT_OF_PLANE = Term("RigidObstacle.point", "point")
NORMAL_OF_PLANE = Term("RigidObstacle.normal", "normal")

SOLVE = Term("`solve`", "`lacore solve` without --bracket")
LOWER_BOUND = Term("lacore.lower_bound", "--bracket")
SOIL_RANGE = Term("lacore.soil_range", "--range")
COULOMB_RANGE = Term("lacore.coulomb_range", "--range")
STABLE = Term("lacore.stable", "--stable")
