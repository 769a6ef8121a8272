"""Functions and classes of lacore that a problem file can use, by their names."""

from collections.abc import Callable, Mapping
from typing import Any

from lacore.model.bodies.blocks import masonry
from lacore.model.bodies.blocks.block_assembly import BlockAssembly, RigidBlock
from lacore.model.bodies.continuum.body import Body
from lacore.model.bodies.frames import sections
from lacore.model.bodies.frames.frame import Frame
from lacore.model.bodies.frames.section import Section
from lacore.model.conditions import footings, loads, water
from lacore.model.conditions.body_forces import BodyForce
from lacore.model.conditions.linear import ByLevel, Linear
from lacore.model.conditions.within import Along, Beyond, Within
from lacore.model.contact import shapes
from lacore.model.contact.interfaces import Interface
from lacore.model.contact.obstacles import RigidObstacle
from lacore.model.materials import hardening
from lacore.model.materials.drucker_prager import DruckerPrager
from lacore.model.materials.fields import Field
from lacore.model.materials.friction import BOND, SMOOTH, STICK, Coulomb, Tresca
from lacore.model.materials.mohr_coulomb import MaximumShear, MohrCoulomb, NoTension, Rankine
from lacore.model.materials.von_mises import VonMises
from lacore.model.meshes.archive import load
from lacore.model.meshes.fans import fan
from lacore.model.meshes.layered import layered
from lacore.model.meshes.naming import named
from lacore.model.meshes.patches import Patch, patches
from lacore.model.meshes.reading import read
from lacore.model.meshes.structured import quadrilaterals, quarter_ring, rectangle
from lacore.model.problem.problem import Problem
from lacore.paths.control import FootingTravel, PointTravel, Time, ToolTravel
from lacore.paths.pace import AdaptiveSteps
from lacore.paths.renewal.mesher import Remeshing
from lacore.paths.selection import LeastNorm
from lacore.paths.sequential import sequential
from lacore.paths.steady import Steady
from lacore.paths.tools.tool import Tool

MAKERS: Mapping[str, Callable[..., Any]] = {
    "la.meshes.rectangle": rectangle,
    "la.meshes.quadrilaterals": quadrilaterals,
    "la.meshes.fan": fan,
    "la.meshes.layered": layered,
    "la.meshes.quarter_ring": quarter_ring,
    "la.meshes.Patch": Patch,
    "la.meshes.patches": patches,
    "la.meshes.read": read,
    "la.meshes.load": load,
    "la.meshes.named": named,
    "la.VonMises": VonMises,
    "la.hardening.Perfect": hardening.Perfect,
    "la.hardening.Linear": hardening.Linear,
    "la.hardening.Voce": hardening.Voce,
    "la.hardening.Swift": hardening.Swift,
    "la.hardening.Table": hardening.Table,
    "la.MohrCoulomb": MohrCoulomb,
    "la.DruckerPrager": DruckerPrager,
    "la.Rankine": Rankine,
    "la.NoTension": NoTension,
    "la.MaximumShear": MaximumShear,
    "la.Body": Body,
    "la.RigidBlock": RigidBlock,
    "la.BlockAssembly": BlockAssembly,
    "la.masonry.running_bond": masonry.running_bond,
    "la.masonry.regular_bond": masonry.regular_bond,
    "la.masonry.Opening": masonry.Opening,
    "la.masonry.stack": masonry.stack,
    "la.masonry.arch": masonry.arch,
    "la.masonry.read": masonry.read,
    "la.masonry.Layer": masonry.Layer,
    "la.masonry.fill": masonry.fill,
    "la.Frame": Frame,
    "la.sections.standard": sections.standard,
    "la.sections.rectangle": sections.rectangle,
    "la.sections.i_section": sections.i_section,
    "la.sections.bar": sections.bar,
    "la.sections.plastic": sections.plastic,
    "la.sections.rigid": sections.rigid,
    "la.sections.Section": Section,
    "la.Within": Within,
    "la.Along": Along,
    "la.Beyond": Beyond,
    "la.Linear": Linear,
    "la.ByLevel": ByLevel,
    "la.Field": Field,
    "la.Fix": loads.Fix,
    "la.Traction": loads.Traction,
    "la.Pressure": loads.Pressure,
    "la.BodyForce": BodyForce,
    "la.PointForce": loads.PointForce,
    "la.RigidFooting": footings.RigidFooting,
    "la.PorePressure": water.PorePressure,
    "la.StandingWater": water.StandingWater,
    "la.WaterTable": water.WaterTable,
    "la.PiezometricLine": water.PiezometricLine,
    "la.Interface": Interface,
    "la.RigidObstacle": RigidObstacle,
    "la.Coulomb": Coulomb,
    "la.Tresca": Tresca,
    "la.Problem": Problem,
    "la.FootingTravel": FootingTravel,
    "la.PointTravel": PointTravel,
    "la.ToolTravel": ToolTravel,
    "la.Time": Time,
    "la.AdaptiveSteps": AdaptiveSteps,
    "la.LeastNorm": LeastNorm,
    "la.Remeshing": Remeshing,
    "la.Steady": Steady,
    "la.Tool": Tool,
    "la.shapes.wedge": shapes.wedge,
    "la.shapes.disc": shapes.disc,
    "la.shapes.plane": shapes.plane,
    "la.shapes.outline": shapes.outline,
    "la.shapes.read_outline": shapes.read_outline,
    "la.sequential": sequential,
}
NAMES: Mapping[str, object] = {"la.SMOOTH": SMOOTH, "la.STICK": STICK, "la.BOND": BOND}
"""Names of values."""
