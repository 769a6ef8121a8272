"""What a solve returns: the limit state, in SI units, with its proof."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np
import pandas as pd
from numpy.typing import ArrayLike

from lacore.assembly.discretisation import Discretisation
from lacore.assembly.water import pore_pressures, total_stress
from lacore.coupling.claims.proving import Ray
from lacore.coupling.interval import Interval
from lacore.coupling.kinds import COUPLINGS
from lacore.limit.carried import CarriedLoads
from lacore.limit.checking import checked
from lacore.limit.constants import RESTING
from lacore.limit.interval import interval_of_state
from lacore.limit.stability import Stability, stability_of
from lacore.limit.tables.contact_table import Table, contact_table
from lacore.limit.tables.held_parts import support_reactions
from lacore.model.bodies.continuum.nodal import point_values
from lacore.model.bodies.continuum.regions import gathering
from lacore.model.bodies.continuum.volume import judged_means
from lacore.numerics.arrays import Floats
from lacore.program.certificate import Certificate
from lacore.program.kinematic import KinematicProgram
from lacore.program.regularization import RegularisedValues
from lacore.program.state import ProgramState
from lacore.reporting import views
from lacore.reporting.errors import typed
from lacore.reporting.findings import Finding
from lacore.reporting.showing import Facts, Picture, counted
from lacore.reporting.status import Claim, Reported, Rigor, Status
from lacore.reporting.text import PYTHON, number
from lacore.solvers.compilation import started

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@dataclass(frozen=True, repr=False)
class LimitState(Reported):
    """A plastic collapse state, or the reason why there is none.

    Attributes:
        status: How the solve ended; its value explains what to do.
        load_factor: Load factor. NaN unless `status` is SOLVED (then the residuals prove it) or
            LOCKED (then +inf).
        rigor: What the load factor proves.
        backend, coupling: Names of the backend and the coupling.
        answered_by: Solver that found the state: the backend, `lacore.coupling.run.PATH_FOLLOWING`,
            or both, if the velocity is from one and the reactions are from the other.
        certificate: Recomputed residuals of the state; None without a state.
        contraction: Last ratio of the change of computed to frozen reactions or slip rates. Below 1
            the plain iteration converges, at 1 it stalls (T11). NaN without two different values.
        bracket: Load factors that enclose every Coulomb load factor (T14), if a loop certified
            none; -inf and +inf if nothing is known. None otherwise. With deformable bodies they
            belong to the discrete problem: the lower end may exceed the load factors of the
            continuum, which `lacore.bracket` encloses.
        regularised: Values of T19 (regularised backends), as load factors.
        history: One row per inner solve: load factor, residuals, statuses, times.
        build_time, solve_time: Wall-clock times of the assembly and of the rest without
            compilation, s.
        compile_time: Time to start the process of a backend and to compile it, s; 0 if that was
            done before.
        options: Options of the backend, as they were given.
        tolerance: Tolerance for the residuals.
        findings: Further findings, see `lacore.reporting.findings`; `message` is their text.
        discretisation: The assembled problem.
        point: Velocity (all unknowns, m/s at ``F0.u = 1``), stresses (Pa) and reactions (Pa, t_n
            with `ContactRows.tension`); None without a state. For a status other than SOLVED it is
            the last iterate, for inspection only. For UNSAFE it is the mechanism that the dead
            loads drive, at ``Fd.u = 1``, with the stresses that carry the largest share of them.
        ray: Proof of LOCKED or UNSAFE, in SI units, with recomputed residuals; None otherwise.
        carried: Load factors with equilibrium, and whether the load factor of a certified Coulomb
            state is the largest of them (capacity), the smallest (minimum holding load) or neither;
            None for other states.
    """

    status: Status
    load_factor: float
    rigor: Rigor
    backend: str
    coupling: str
    certificate: Certificate | None
    contraction: float
    bracket: tuple[float, float] | None
    regularised: RegularisedValues | None
    history: pd.DataFrame
    build_time: float
    solve_time: float
    options: Mapping[str, Any]
    tolerance: float
    findings: tuple[Finding, ...]
    discretisation: Discretisation
    point: ProgramState | None
    ray: Ray | None = None
    answered_by: str = ""
    compile_time: float = 0.0
    carried: CarriedLoads | None = None

    def _point(self) -> ProgramState:
        return self.required(self.point)

    @property
    def program(self) -> KinematicProgram:
        """Program of the state for all unknowns, in SI units, evaluated at the state.

        It contains the yield stresses after hardening, the friction of soils at their pressure, and
        the strengths that the coupling uses.
        """
        point = self._point()
        program = COUPLINGS[self.coupling].program_of(self.discretisation.full)
        return program.at_state(point.velocity, point.mean_stress)

    @property
    def claim(self) -> Claim:
        """What the load factor proves, with its role among those that have equilibrium."""
        own = self.discretisation.claim(self.rigor)
        return own if self.carried is None else self.carried.role.qualified(own)

    @property
    def outer_iterations(self) -> int:
        """Number of inner solves of the coupling loop."""
        return len(self.history)

    @property
    def peak_memory(self) -> float:
        """Largest resident memory of the backend's process, MB; NaN without such a process."""
        return float(self.history["peak_memory"].max())

    @property
    def velocity(self) -> dict[str, Floats]:
        """Velocity by body, at ``F0.u = 1`` (UNSAFE: ``Fd.u = 1``); its magnitude has no meaning.

        Continua have velocities at their nodes (`BodyDofs.nodes`), shape (2, nodes), m/s. Rigid
        blocks have u_x, u_y of the centroid, m/s, and the anticlockwise rotation rate, rad/s, shape
        (3, blocks); three-dimensional ones u_x, u_y, u_z and rotation rates about x, y, z, shape
        (6, blocks). Frames have the same at their nodes, shape (3, nodes).
        """
        u = self._point().velocity
        nodal = {name: u[dofs.dofs] for name, dofs in self.discretisation.continua.items()}
        blocks = {name: dofs.motion(u) for name, dofs in self.discretisation.blocks.items()}
        frames = {name: dofs.motion(u) for name, dofs in self.discretisation.frames.items()}
        return nodal | blocks | frames

    @property
    def stress(self) -> dict[str, Floats]:
        """Total stress (xx, yy, zz, xy) at the strain points of continua, (elements, q, 4), Pa.

        Of axisymmetric bodies (rr, zz, tt, rz), t the hoop. Tension is positive.
        """
        water = self.pore_pressure
        return {name: total_stress(own, water[name]) for name, own in self.effective_stress.items()}

    @property
    def effective_stress(self) -> dict[str, Floats]:
        """What the skeleton carries of `stress`, and criteria judge (T64): without water all."""
        point = self._point()
        result = {}
        # Jumps and hinges come after the continua.
        bodies = self.discretisation.continua
        stresses = gathering.by_body(bodies, point.stress)
        for (name, dofs, own), (*_, means) in zip(
            stresses, gathering.by_body(bodies, point.mean_stress), strict=True
        ):
            result[name] = gathering.continuum_stress(dofs, own, judged_means(dofs.velocity, means))
        return result

    @property
    def pore_pressure(self) -> dict[str, Floats]:
        """Pressure of the water in the pores of continua there, shape (elements, q), Pa."""
        d = self.discretisation
        water = pore_pressures(d.problem, self._point().load_factor)
        return {name: point_values(dofs, water[name]) for name, dofs in d.continua.items()}

    @property
    def dissipation(self) -> dict[str, Floats]:
        """Plastic power of elements per volume by continuum, shape (elements,), at F0.u = 1.

        W/m^3 where the load is in N, that is of axisymmetric bodies; W/m^2 per unit thickness.
        Within a step of a path bodies harden, and it is that of the yield stress by then.

        That of a velocity jump goes to both elements, half each; past supports and footings all of
        it to the one there is.
        """
        u, d = self._point().velocity, self.discretisation
        power = {
            name: gathering.element_sums(dofs.body, [group.dissipation(u) for group in groups])
            for name, dofs, groups in gathering.by_body(d.continua, self.program.groups)
        }
        for jumps in d.jumping:
            halves = jumps.group.dissipation(u) / 2
            for name, side in zip(jumps.bodies, jumps.elements, strict=True):
                np.add.at(power[name], side, halves)
        return {name: value / d.continua[name].volumes for name, value in power.items()}

    @property
    def hinges(self) -> pd.DataFrame:
        """Potential plastic hinges of frames: place, moment and M_p (N), rotation rate (rad/s).

        The table has one row per end of a rigid piece that carries moment, and two where a member
        passes through a node. The moment is that of the member on its node, the rotation rate (at
        ``F0.u = 1``) that of the member relative to its node, both anticlockwise: a hinge
        dissipates their product. If equal members meet, the split of the rotation between their
        ends is arbitrary. Members that yield to axial force also have that force (N/m, tension
        positive), its limit and the rate of elongation (m/s). Bars have no node. `state` is
        ``turns``, ``stretches`` or ``rests``.
        """
        point, frames = self._point(), self.discretisation.frames
        rest = RESTING * float(np.abs(point.velocity).max(initial=0.0))
        tables = []
        for group, stress in zip(self.discretisation.full.groups, point.stress, strict=True):
            if group.name in frames:
                dofs = frames[group.name]
                table = dofs.hinges(point.velocity, stress[:, 0], rest)
                table.insert(0, "frame", group.name)
                tables.append(table)
        return pd.concat(tables, ignore_index=True) if tables else pd.DataFrame()

    @property
    def reactions(self) -> pd.DataFrame:
        """Contact points: place, length, tractions on the slave (Pa), velocities, stick/slip/open.

        Crushing joints of three-dimensional blocks have the state ``crush``, with ``u_n < 0``.

        `slave` and `master` are the names of the blocks or bodies that touch, or "obstacle". The
        normal points from the master into the slave, and the tangent is the normal turned by +90
        degrees. `length` is the part of the edge that a point represents, m, or of the surface of
        axisymmetric bodies, m^2; tractions times `length` are forces. For three-dimensional blocks
        `area`, m^2, replaces it, and tangential tractions and velocities are vectors `t_t_x`,
        `t_t_y`, `t_t_z`. ``t_n > 0`` is compression, that of the skeleton for a body with pore
        water (T64). Along a path `gap` is the distance from the obstacle at the start of the step,
        m; a point that the step does not close is open, although it may approach (``u_n < 0``).
        Pressures oscillate from point to point, so use their sums and averages.
        """
        return contact_table(self.discretisation, self._point())

    @typed()
    def certify(
        self,
        *,
        load_factor: float | None = None,
        velocity: Mapping[str, ArrayLike] | None = None,
        stress: Mapping[str, ArrayLike] | None = None,
        reactions: Table | None = None,
        hinges: Table | None = None,
        point: ProgramState | None = None,
    ) -> Certificate:
        """Recompute the residuals of the stored state, or of one with parts of it replaced.

        This needs no solver. ``state.certify(load_factor=1.01 * state.load_factor)`` shows that an
        error is detected, with ``.holds(state.tolerance)``. The laws are those of the coupling:
        ``associated``, ``frictionless`` and ``stick`` solve other problems than the given one.

        Args:
            load_factor: Replaces `load_factor`.
            velocity: Replaces `velocity` of some bodies. Footings move with their nodes. Motion
                that supports or rigid members prevent counts as penetration.
            stress: Replaces `stress` of some continua. A part without power at all strain rates of
                the body counts as violation of normality.
            reactions: A copy of `reactions` with other `t_n` and `t_t`; nothing else is read.
            hinges: A copy of `hinges` with another `moment`; nothing else is read.
            point: Replaces `point`, with its own load factor, for all unknowns in SI units.

        Raises:
            InputError: A name, a shape or a table does not belong to this state.
            ValueError: There is no state.
        """
        stored = self._point()
        if np.isfinite(self.load_factor):
            stored = replace(stored, load_factor=self.load_factor)
        return checked(
            self.discretisation,
            point or stored,
            self.coupling,
            load_factor=load_factor,
            velocity=velocity,
            stress=stress,
            reactions=reactions,
            hinges=hinges,
        )

    def interval(self) -> Interval:
        """Compute all load factors that this mechanism can carry, by two more solves (T14b a).

        They are solved by the backend of this state. The interval is in SI units; each of its ends
        has its own reactions and certificate.

        Raises:
            InputError: There is no mechanism, as in a LOCKED state.
        """
        return interval_of_state(
            self.discretisation, self.point, self.backend, self.options, self.tolerance
        )

    def stability(self) -> Stability:
        """Compute whether the dead loads alone are carried, and which load factors are.

        This solves one more conic program where they are carried, a few where they are not, and
        none without dead loads, by the backend of this state, whatever its status.
        """
        known = self.load_factor if self.status in (Status.SOLVED, Status.LOCKED) else np.nan
        return stability_of(
            self.discretisation,
            self.backend,
            self.options,
            self.coupling,
            self.tolerance,
            known,
            carried=self.carried,
        )

    def facts(self) -> Facts:
        """What is known: nothing is computed for it."""
        told = {"status": self.report.summary_for(PYTHON)}
        if self.certificate is not None:
            told["residual"] = self.certificate.summary
        elif self.ray is not None:
            told["proof"] = str(self.ray)
        if self.bracket is not None:
            lower, upper = self.bracket
            of = self.discretisation.scope.phrase
            told["bracket"] = f"every Coulomb load factor{of} is in [{lower:.7g}, {upper:.7g}]"
        elif self.regularised is not None:
            values = self.regularised
            told["energies"] = f"alpha_reg {values.alpha_reg:.7g}, plastic {values.plastic:.7g}"
        solves = counted(self.outer_iterations, "inner solve")
        told["solved by"] = (
            f"{self.backend}, {self.coupling} coupling: {solves} in {self.solve_time:.3g} s,"
            f" after {self.build_time:.3g} s of assembly"
        )
        told |= started(self.compile_time)
        told["size"] = self.discretisation.contents
        size = number(self.load_factor, ".7g")
        return Facts(f"LimitState: load factor {size}, {self.claim.text}", told)

    def picture(self) -> Picture:
        """The mechanism, or where there is none the problem."""
        if self.point is None:
            return Picture(self.discretisation.problem.plot(), "the problem: there is no mechanism")
        return Picture(self.plot())

    def __str__(self) -> str:
        """Return the load factor, what it proves, its largest residual and the message."""
        named = f"{self.backend}, {self.coupling} coupling, {self.status.label}"
        lines = [f"load factor {number(self.load_factor, '.6g')} ({self.claim}; {named})"]
        if self.certificate is not None:
            residual, size = self.certificate.worst
            lines.append(f"largest residual {size:.1e} ({residual})")
        if self.status is not Status.SOLVED:
            lines.append(self.message)
        elif note := self.report.notes_for(PYTHON):
            lines.append(note)
        if self.ray is not None:
            lines.append(f"proof: {self.ray}")
        return "\n".join(lines)

    @cached_property
    def support_reactions(self) -> pd.DataFrame:
        """Forces of supports and rigid footings on what they hold or move, N/m, and moments, N.

        Of axisymmetric bodies forces around the whole ring, N.
        On the nodes of continua and of frames, and at the centroids of rigid blocks. A frame that
        is held twice along a member gets the least of the forces that its supports may exert.
        """
        return support_reactions(self.discretisation, self._point())

    def plot(self) -> Figure:
        """Mechanism and forces: see `lacore.pictures.mechanism.plot_mechanism`."""
        return views.picture(self)

    def plot_section(self, point: Sequence[float], normal: Sequence[float]) -> Figure:
        """A cut through tetrahedra: see `lacore.pictures.space.section.plot_section`.

        Example:
            >>> mesh = la.meshes.box(x=(0, 1), y=(0, 1), z=(0, 2), nx=1, ny=1, nz=2)
            >>> column = la.Body(mesh, la.VonMises(40e3), kinematics="3d")
            >>> sides = [la.Fix("column", side, "normal") for side in ("left", "front", "bottom")]
            >>> problem = la.Problem({"column": column}, [la.Pressure("column", "top", 1e3)], sides)
            >>> figure = la.solve(problem).plot_section((0, 0.5, 0), (0, 1, 0))
            >>> figure.axes[0].get_xlabel(), figure.axes[0].get_ylabel()
            ('x [m]', 'z [m]')
        """
        return views.section(self, point, normal)

    def to_vtu(self, path: str | PathLike[str]) -> None:
        """A file for ParaView: see `lacore.files.vtu.write_state`."""
        views.files(self, path)

    def to_html(self, path: str | PathLike[str]) -> None:
        """A scene that one can turn: see `lacore.pictures.space.interactive.write_scene`."""
        views.scene(self, path)
