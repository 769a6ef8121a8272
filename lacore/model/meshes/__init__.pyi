"""Names of `la.meshes`: where each is found, for `__init__` and for type checkers."""

from .archive import load as load
from .archive import save as save
from .checks import quality as quality
from .curved import isoparametric as isoparametric
from .fans import fan as fan
from .layered import layered as layered
from .naming import named as named
from .patches import Patch as Patch
from .patches import patches as patches
from .reading import read as read
from .renewal.outline import remeshed as remeshed
from .renewal.sizes import element_sizes as element_sizes
from .solid.box import box as box
from .solid.extruded import extruded as extruded
from .structured import graded as graded
from .structured import quadrilaterals as quadrilaterals
from .structured import quarter_ring as quarter_ring
from .structured import rectangle as rectangle
from .structured import split as split
from .structured import unaligned as unaligned
