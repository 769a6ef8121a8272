"""Pictures of results, and the function that draws, cuts, animates or writes each kind of result.

These functions are imported when they are called: `import lacore` does not load matplotlib.
"""

from lacore.reporting import views

views.picture.makers |= {
    "lacore.model.bodies.continuum.body:Body": "lacore.pictures.mesh:plot_body",
    "lacore.model.problem.problem:Problem": "lacore.pictures.sketch.problem:plot_problem",
    "lacore.limit.state:LimitState": "lacore.pictures.mechanism:plot_mechanism",
    "lacore.bounds.lower:LowerBound": "lacore.pictures.mesh:plot_strength",
    "lacore.bounds.gap_identity:GapIdentity": "lacore.pictures.mesh:plot_gap",
    "lacore.bounds.bracket.bracket:Bracket": "lacore.pictures.bracket:plot_bracket",
    "lacore.paths.path:Path": "lacore.pictures.path:plot_path",
    "lacore.analyses.load_cases:LoadCases": ("lacore.pictures.analyses:plot_load_cases"),
    "lacore.analyses.yield_surface.envelope:Envelope": ("lacore.pictures.analyses:plot_envelope"),
    "lacore.analyses.critical:Critical": "lacore.pictures.analyses:plot_critical",
    "lacore.analyses.position:WorstPosition": ("lacore.pictures.analyses:plot_worst_position"),
    "lacore.analyses.sensitivity:Sensitivity": ("lacore.pictures.analyses:plot_sensitivity"),
    "lacore.analyses.stable:Stable": "lacore.pictures.analyses:plot_stable",
}
views.curve.makers |= {
    "lacore.paths.path:Path": "lacore.pictures.path:plot_force",
}
views.thumbnail.makers |= {
    "lacore.model.problem.problem:Problem": "lacore.pictures.thumbnails:thumbnail_of_problem",
    "lacore.limit.state:LimitState": "lacore.pictures.thumbnails:thumbnail_of_state",
    "lacore.paths.path:Path": "lacore.pictures.thumbnails:thumbnail_of_path",
}
views.section.makers |= {
    "lacore.limit.state:LimitState": "lacore.pictures.space.section:plot_section",
    "lacore.bounds.lower:LowerBound": "lacore.pictures.space.section:plot_strength_section",
}
views.animation.makers |= {
    "lacore.paths.path:Path": "lacore.pictures.animation:animate_path",
}
views.scene.makers |= {
    "lacore.limit.state:LimitState": "lacore.pictures.space.interactive:write_scene",
}
views.files.makers |= {
    "lacore.limit.state:LimitState": "lacore.files.vtu:write_state",
    "lacore.paths.path:Path": "lacore.files.vtu:write_path",
}
views.series.makers |= {
    "lacore.paths.path:Path": "lacore.files.vtu:extend_series",
}
