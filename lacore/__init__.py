"""lacore: plastic collapse loads of bodies in frictional contact, each with its own proof."""

from lacore import hardening, masonry, meshes
from lacore.adaptivity import bracket
from lacore.assembly import Discretisation, discretise
from lacore.backend import backend_names, find_backend
from lacore.blocks import BlockAssembly, RigidBlock
from lacore.bodies import Body
from lacore.brackets import Bracket, Ending
from lacore.certificate import Certificate
from lacore.control import FootingTravel, PointTravel, Time
from lacore.coulomb_range import CoulombRange, coulomb_range
from lacore.criteria import VonMises
from lacore.errors import CapabilityError, InputError, LacoreError, SolveError
from lacore.frames import Frame
from lacore.gap_identity import GapIdentity, gap_identity
from lacore.interfaces import SMOOTH, STICK, Coulomb, Interface, RigidObstacle, Tresca
from lacore.intervals import Interval
from lacore.isolation import SolverProcess
from lacore.kinematic_bound import UpperBound, upper_bound
from lacore.loads import BodyForce, Fix, PointForce, Pressure, RigidFooting, Traction
from lacore.pace import AdaptiveSteps
from lacore.path import Path
from lacore.problem import Problem
from lacore.result import LimitState
from lacore.selection import LeastNorm
from lacore.sequential import sequential
from lacore.solving import solve
from lacore.stability import Stability, Standing
from lacore.static_bound import LowerBound, lower_bound
from lacore.status import Rigor, Status

__all__ = [
    "SMOOTH",
    "STICK",
    "AdaptiveSteps",
    "BlockAssembly",
    "Body",
    "BodyForce",
    "Bracket",
    "CapabilityError",
    "Certificate",
    "Coulomb",
    "CoulombRange",
    "Discretisation",
    "Ending",
    "Fix",
    "FootingTravel",
    "Frame",
    "GapIdentity",
    "InputError",
    "Interface",
    "Interval",
    "LacoreError",
    "LeastNorm",
    "LimitState",
    "LowerBound",
    "Path",
    "PointForce",
    "PointTravel",
    "Pressure",
    "Problem",
    "RigidBlock",
    "RigidFooting",
    "RigidObstacle",
    "Rigor",
    "SolveError",
    "SolverProcess",
    "Stability",
    "Standing",
    "Status",
    "Time",
    "Traction",
    "Tresca",
    "UpperBound",
    "VonMises",
    "backend_names",
    "bracket",
    "coulomb_range",
    "discretise",
    "find_backend",
    "gap_identity",
    "hardening",
    "lower_bound",
    "masonry",
    "meshes",
    "sequential",
    "solve",
    "upper_bound",
]
