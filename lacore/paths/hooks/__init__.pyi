"""The public names of la.hooks, each with the file that has it. See DESIGN.md."""

from .writers import animation as animation
from .writers import curve as curve
from .writers import progress as progress
from .writers import table as table
from .writers import vtu as vtu
