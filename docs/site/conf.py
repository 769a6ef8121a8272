"""How Sphinx makes the site: ``make docs``. Its pages are put together by `build.py`."""

import sys
from pathlib import Path

from lacore import __version__
from lacore.model.problem import types

sys.path.insert(0, str(Path(__file__).parent))

project = "lacore"
author = "The lacore developers"
project_copyright = "the lacore developers, BSD-3-Clause"
version = release = __version__

extensions = [
    "myst_parser",
    "sphinx_design",
    "sphinx.ext.autodoc",
    "sphinx.ext.napoleon",
    "sphinx.ext.viewcode",
    "theory_links",
    "docstrings",
]
exclude_patterns = ["extra"]

myst_enable_extensions = ["colon_fence", "deflist", "attrs_block"]
myst_heading_anchors = 4
myst_links_external_new_tab = False
smartquotes = False
suppress_warnings = ["ref.python"]  # `low` in a docstring may be that of several classes

default_role = "py:obj"  # `la.solve` in a docstring is a link, where there is such a thing
autodoc_default_options = {"members": True, "member-order": "bysource"}
autodoc_typehints = "signature"
autodoc_typehints_format = "short"
autodoc_preserve_defaults = True
autodoc_type_aliases = {
    **{name: f"~lacore.types.{name}" for name in types.__all__},
    "ArrayLike": "~numpy.typing.ArrayLike",
    "Table": "~lacore.limit.tables.contact_table.Table",
}
autodoc_class_signature = "mixed"
napoleon_google_docstring = True
napoleon_numpy_docstring = False
napoleon_use_ivar = True
napoleon_use_rtype = False
python_use_unqualified_type_names = True
python_maximum_signature_line_length = 78

html_theme = "furo"
html_title = "lacore"
html_static_path = ["static"]
html_css_files = ["charts.css", "site.css"]
html_copy_source = False
html_show_sphinx = False
html_theme_options = {"navigation_with_keys": True}
pygments_style = "friendly"
pygments_dark_style = "github-dark"
