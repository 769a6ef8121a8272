"""All kinds of findings, each with its text (see `lacore.reporting.findings.fill`)."""

from collections.abc import Mapping
from enum import Enum


class Kind(Enum):
    """Kind of a finding. The value is its text for Python users."""

    # End of a mechanism
    REACHES_SUPPORT = (
        "the mechanism reaches {where}: if the material continues there, make the body larger,"
        " because the load factor may decrease"
    )
    REACHES_ROLLERS = (
        "the mechanism reaches {where}: unless this is a plane of symmetry or the end of the"
        " material, make the body larger, because the load factor may change"
    )
    MORE_GROUND = (
        "the mechanism reaches {where}: with {depth} of additional ground, the load factor is"
        " {percent:.0f} % lower; if the ground continues there, make the body larger"
    )

    CORNERS_DRIVEN = (
        "of {where!r} the mechanism drives corners of {one!r} and {other!r} into each other at"
        " {place} (such corners: {count}), and contact at corners is not modelled: cut one off,"
        " so that edges touch there"
    )
    CORNERS_MAY_BE_DRIVEN = (
        "of {where!r} the mechanism may drive corners of {one!r} and {other!r} into each other at"
        " {place} (such corners: {count}), and contact at corners is not modelled: cut one off,"
        " so that edges touch there"
    )
    OPENS = "{where} sticks, but opens freely: {terms.BOND} in its place carries tension, too"
    CELLS_FALL = (
        "this is proven of the cells of joints that crush: the joints carry more than these; finer"
        " cells (lacore.Crushing, divisions) show how much"
    )
    POLYGONS_FALL = (
        "this is proven of the polygons inside the yield curves of sections, which carry less;"
        ' polygons around them (polygon "outer") show how much'
    )
    POLYGONS_INSIDE = (
        'sections are replaced by polygons inside their yield curves: the option polygon "outer"'
        " gives an upper bound"
    )
    POLYGONS_AROUND = (
        'sections are replaced by polygons around their yield curves: the option polygon "inner"'
        " gives a lower bound"
    )
    NO_STANDING_WATER = (
        "where free water stands on the ground, it acts on the ground, too: state a StandingWater"
    )

    # Input
    DIMENSIONS = (
        "{where!r} has a size of {size}, which is implausible for a material with {why}: state the"
        " unit of its coordinates if they are not in m"
    )
    TABLE_SNAPPED = "the water table of {where} at {height} was moved to the vertices at {moved}"
    MESH_CHANGED = "the mesh of {where!r}: {text}"

    # Limits of what a load factor shows
    OTHER_LOAD_FACTORS = (
        "other load factors may exist, because flow is not associated; {terms.SOIL_RANGE} searches"
        " for them"
    )
    MINIMUM_HOLDING_LOAD = (
        "this is the minimum holding load: no equilibrium exists below it, and {loads} are carried"
    )
    EQUILIBRIUM_ON_BOTH_SIDES = (
        "{loads} have equilibrium within the friction cones, which does not exclude that the"
        " structure moves"
    )
    LOCKS_IN_FORCES = (
        "all load factors have equilibrium within the friction cones, because the contact can lock"
        " in forces of any size (prestress); without them the structure may move below and above"
        " this load factor"
    )
    NEGATIVE = (
        "the load factor is negative: the dead loads alone may not be carried; see"
        " `state.stability()`"
    )
    POLYGON = (
        "it is of the polygon that approximates a curved outline"
        " (Body.geometry='approximated'), not of the body"
    )
    SHARED_CORNERS = (
        "contact points with friction meet at a corner, where reactions, and with them the load"
        " factor, may not be unique"
    )
    BRACKET = "every Coulomb load factor is in [{lower:.6g}, {upper:.6g}]"
    BRACKET_OF_MESH = (
        "every Coulomb load factor of the discrete problem is in [{lower:.6g}, {upper:.6g}]"
    )
    LOCKED_ON_MESH = (
        "this is proven of the discrete problem: a deformable body may have a motion that this mesh"
        " does not have; refine the mesh{space}, or use {terms.LOWER_BOUND}, which considers the"
        " continuum"
    )

    # Reasons for results without certificate
    LOAD_OUTSIDE_CONES = (
        "the load lies outside of the friction cones: no reactions within them carry a part of it"
    )
    LOWER_MECHANISM = (
        "the residuals are small, but the associated law has a mechanism at a lower load factor"
    )
    NO_REACTIONS = (
        "no reactions were found that carry a load, though the associated friction law has some"
    )
    UNSAFE_NOT_PROVEN = (
        "the solver calls the structure unsafe, and no mechanism of the dead load proves it"
    )
    LOCKED_NOT_PROVEN = (
        "the solver calls the load locked, and no reactions carry it alone: the closest leave"
        " {residual:.1e} of the forces"
    )
    LOCKED_UNKNOWN = (
        "the solver calls the load locked, and no program found reactions that carry it alone: take"
        " another backend, or a coarser mesh"
    )
    LOCKED_REFUTED = (
        "the solver calls the load locked, but the program is feasible: backend {backend!r} finds"
        " an admissible mechanism with F0.U = 1 (penetration {penetration:.1e}, divergence"
        " {divergence:.1e}, normalisation {normalisation:.1e})"
    )
    DEAD_LOADS = "{standing}"
    CONTINUUM_NOT_PROVEN = (
        "of the discrete problem it {standing}, of the continuum this is not proven: {why}"
    )
    STANDS_ON_MESH = "proven for this mesh; {terms.STABLE} proves it for the continuum"
    MOMENTS_INSIDE = (
        "moments inside members exceed the plastic moment by {excess:.1e}: put nodes where they"
        " peak"
    )
    HARDLY_STRONG = (
        "{where!r} has no strength without pressure, with which solvers often fail: give it a"
        " negligible cohesion or tensile strength, {lent} (Rankine for NoTension), which hardly"
        " raises the load factor; or take another of the backends 'clarabel' and 'interior_point'"
    )

    # Bounds
    ADMISSIBLE_STRESSES = (
        "admissible stresses prove it, about {gap:.1e} of the power below the best that these"
        " elements have; the solver reports {native!r}"
    )
    NO_STRESSES = (
        "no stress of these elements carries the dead loads; refine the mesh, unless `solve` finds"
        " that they collapse the structure"
    )
    STRESSES_NOT_ADMISSIBLE = (
        "stresses stay {equilibrium:.1e} of the load out of equilibrium, or beyond strength by"
        " {beyond:.1e}"
    )
    STRENGTH_TOO_SMALL = (
        "{where!r} has a strength of {strength} without pressure, which is too small for a proof:"
        " give it a negligible cohesion or tensile strength, {lent} (Rankine for NoTension), or"
        " take another of the backends 'clarabel' and 'interior_point'"
    )
    LENT_COHESION = (
        "{where!r} has a lent cohesion or tensile strength of {lent}: lower bounds apply to the"
        " body with it, upper bounds also to the body as stated"
    )
    COARSE_TOLERANCE = (
        "tighten the backend's tolerance, or fix the mesh (smallest angle {angle:.2g} degrees)"
    )
    FORCES_NOT_SETTLED = (
        "the load factor grows as quadratic stresses of body forces leave less of strengths; refine"
        " the mesh, or give forces by elements"
    )
    VELOCITY_NOT_ADMISSIBLE = (
        "the velocity leaks {leak:.1e}, or penetrates by {penetration:.1e}; tighten the backend's"
        " tolerance, or fix the mesh"
    )
    FLOW_NOT_POSSIBLE = (
        "soil dilates too little for its friction, {regions} of the largest strain rate: its"
        " supports hardly let it move; move supports farther away, or refine the mesh{space}"
    )
    REGION_BEYOND = "{where!r} by {size:.1e}"
    BOUNDS_PROVEN = "both bounds are proven"
    BOUNDS_PROVEN_OF_COULOMB = "both bounds are proven of every Coulomb load factor"
    BOUNDS_OF_POLYGON = (
        "both bounds are of the polygon that approximates a curved outline"
        " (Body.geometry='approximated'), not of the body"
    )
    BOUNDS_CROSS = "lower bound {lower:.9g} above upper bound {upper:.9g}, width {width:.3%}"
    BOUND_STOPPED = "{where} bound stopped at {elements} elements: {why}"
    BOUNDS_STOPPED = "{where} bounds stopped at {elements} elements: {why}"
    NEXT_SOLVE_LATE = "a solve of {elements} would end after the time limit"
    BOUND_FAILED = "{where} bound: {why}"
    NONE_WITHOUT_FRICTION = "none; without Coulomb friction the dead loads collapse the structure"
    NONE_WITH_ASSOCIATED_FRICTION = "none; with associated friction stresses carry any load"
    NO_BOUND = "no {where} bound: {why}"
    STRAIGHT_EDGES = "straight edges approximate curved ones"
    CELLS_OF_JOINTS = "cells approximate joints that crush, which lacore.crushing_bracket encloses"
    STEP_OF_PATH = "a state within a step of a path has none"
    STOPPED_IN_RESTART = "by its time limit of {limit:g} s, in restart {done} of {every}"
    STOPPED_AFTER_SEARCHES = "by its time limit of {limit:g} s, after {done} of {every} searches"

    # Paths
    ELEMENT = "element {element} of {where!r} near {place}, after {share} of the step"
    EVENT = "{what}"
    FOLD = "the boundary of {where!r} touches itself near {place}"
    CORNER_INSIDE = "{where}: a corner of one body is {depth} inside the other near {place}"
    CONTACTS = "{where}"
    TOOLS = "tools {where!r}"
    LOAD_FACTOR = "the load factor is {load_factor:.3g}"
    SPEED = "the speed of the control is {speed:.3g}"
    STEP_ERROR = "the error of the step is {error:.3g}"
    OTHER_SHAPES = "another scheme, or other steps, meet other shapes on the way, and may continue"
    STRAIN_TOO_LARGE = "a point would strain by more than a step allows: take smaller steps"
    REFUSED = "{error}"
    REMESHING_FAILED = "remesh fails: {error}"
    HOOK_FAILED = "hook {hook!r} ({when}) raised {error} ({place})"
    VELOCITY_NOT_UNIQUE = (
        "at step {step} the velocity became one of many: from this step on the most regular one"
        " was selected, as by selection=lacore.LeastNorm()"
    )
    LOAD_DRIFTS = (
        "the load drifts by {drift:.2g} of its mean over the last {window:.4g} of the"
        " travel (tolerance {tolerance:g}), velocities differ by {change:.2g} (tolerance {flow:g})"
    )
    STEADY = "from step {step} on load and flow are stationary: {loads}"
    NOT_STEADY = "not steady: {loads}"
    FEW_STEPS = (
        "not steady: a window needs {least} steps after the first one, and the path has {steps}"
    )
    WINDOW_NOT_USABLE = (
        "not steady: the window of {window:.4g} is not usable: it covers {covered} of {steps}"
        " steps, and {least} or more after the first one are needed"
    )

    # Analyses
    OTHER_CROSSINGS = "the first of {count} that were seen: also {others}"
    NOT_CERTIFIED_AT = "not certified at {places}"
    NO_POSITION = "no position has a certified load factor"
    LOWEST_POSITION = (
        "the lowest of {count} positions, certified; lower load factors between the positions,"
        " which are at most {spacing:.3g} apart, are not excluded"
    )
    NO_CASE = "no case is certified: {cases}"
    GOVERNS = "{where!r} governs"
    GOVERNS_OF_CERTIFIED = "{where!r} governs of those that are certified; not certified: {cases}"
    ONE_GOVERNS = "one of {cases} governs: brackets overlap"
    LEAST_CASE = (
        "{where!r} has the least load factor; that it governs is not proven against {cases}: take"
        " target_width for deformable bodies, {terms.COULOMB_RANGE} for friction"
    )
    SLACK = (
        "directions of slip turn continuously in three dimensions: the ends have a gap of the"
        " tolerance, which moves them by about {lower:.1e} and {upper:.1e} in load factor"
    )
    BY_MULTIPLIERS = "by multipliers of the state (envelope theorem)"
    BY_DIFFERENCES = (
        "by differences of certified load factors on either side, accurate to about 1e-3 of an"
        " elasticity: friction or flow that is not associated has no envelope theorem"
    )
    ONE_SIDED = (
        "the derivatives by {parameters} are one-sided: the load factor has a kink there, see"
        " `left` and `right`"
    )
    NO_DERIVATIVE = "no derivative by {parameters} (see the table)"
    LEFT_OUT = "not in the table: {loads}"
    APART = "inner and outer at most {width:.2%} apart"
    UNBOUNDED = "unbounded: some combinations are carried however large"
    POINTS_ALONE = (
        "certified states only: nothing is proven between them, because friction is not associated"
    )
    DIRECTIONS_FAILED = "{count} of {every} directions have no result (see the table)"
    DIRECTIONS_ENDED = "ended after {count} directions: {why}"
    NO_VOLUME = "what is proven so far encloses no volume (see the table)"
    NOTHING_PROVEN = "in {count} directions nothing was proven (see the table)"
    CORNERS_SOLVED = (
        "all corners of the outer hull lie on directions that were solved; only narrower bounds for"
        " each direction can reduce the distance further"
    )

    # Answers
    SOLVE = "its solve: {report}"
    STATUS = "{report}"
    NO_ANSWER = "backend {backend!r} has no certified answer: {report}"

    # Backends
    NATIVE_STATUS = "the solver itself reports {native!r}, but the residuals prove the solution"
    BACKEND = "the backend reports: {text}"
    EARLIER = "an earlier version of lacore reported: {text}"


FILES: Mapping[Kind, str] = {
    Kind.POLYGON: (
        'it is of the polygon that approximates a curved outline (geometry = "approximated"), not'
        " of the body"
    ),
    Kind.BOUNDS_OF_POLYGON: (
        "both bounds are of the polygon that approximates a curved outline"
        ' (geometry = "approximated"), not of the body'
    ),
    Kind.VELOCITY_NOT_UNIQUE: (
        "at step {step} the velocity became one of many: from this step on the most regular one"
        " was selected, as by a table [path.selection]"
    ),
    Kind.LEAST_CASE: (
        "{where!r} has the least load factor; that it governs is not proven against {cases}: use"
        " {terms.LOWER_BOUND} for deformable bodies, {terms.COULOMB_RANGE} for friction"
    ),
    Kind.CELLS_OF_JOINTS: "cells approximate joints that crush",
    Kind.CELLS_FALL: (
        "this is proven of the cells of joints that crush: the joints carry more than these; finer"
        " cells (divisions) show how much"
    ),
    Kind.NEGATIVE: (
        "the load factor is negative: the dead loads alone may not be carried; see the line on dead"
        " loads"
    ),
    Kind.NO_STANDING_WATER: (
        "where free water stands on the ground, it acts on the ground, too: add a load of the kind"
        ' "standing-water"'
    ),
}
"""Texts for users of problem files, where other names are not enough."""
