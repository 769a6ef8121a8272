"""Who draws, cuts, animates and writes what: the top floor, the only one that knows all rooms.

What does the work is imported when it is asked for: `import lacore` loads no matplotlib.
"""

from lacore import views

views.picture.makers |= {
    "lacore.bodies.continuum.body:Body": "lacore.pictures.mesh:plot_body",
    "lacore.problem.problem:Problem": "lacore.pictures.sketch.problem:plot_problem",
    "lacore.limit.state:LimitState": "lacore.pictures.mechanism:plot_mechanism",
    "lacore.bounds.lower:LowerBound": "lacore.pictures.mesh:plot_strength",
    "lacore.bounds.gap_identity:GapIdentity": "lacore.pictures.mesh:plot_gap",
    "lacore.adaptive.bracket:Bracket": "lacore.pictures.bracket:plot_bracket",
    "lacore.paths.path:Path": "lacore.pictures.path:plot_path",
    "lacore.questions.load_cases:LoadCases": ("lacore.pictures.analyses:plot_load_cases"),
    "lacore.questions.yield_surface.envelope:Envelope": ("lacore.pictures.analyses:plot_envelope"),
    "lacore.questions.critical:Critical": "lacore.pictures.analyses:plot_critical",
    "lacore.questions.position:WorstPosition": ("lacore.pictures.analyses:plot_worst_position"),
    "lacore.questions.sensitivity:Sensitivity": ("lacore.pictures.analyses:plot_sensitivity"),
    "lacore.questions.stable:Stable": "lacore.pictures.analyses:plot_stable",
}
views.curve.makers |= {
    "lacore.paths.path:Path": "lacore.pictures.path:plot_force",
}
views.thumbnail.makers |= {
    "lacore.problem.problem:Problem": "lacore.pictures.thumbnails:thumbnail_of_problem",
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
