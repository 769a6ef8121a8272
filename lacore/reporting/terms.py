"""Names that appear in several messages, as written in Python and in problem files."""

from lacore.reporting.text import Term

SMOOTH = Term("lacore.SMOOTH", '"smooth"')
STICK = Term("lacore.STICK", '"stick"')
BOND = Term("lacore.BOND", '"bond"')
