"""What a result can be asked to show: its picture, a section, film, files, scene.

A result knows neither matplotlib nor meshio, nor who uses them: `lacore.pictures` says which
function makes a view of what. Both are named, not imported: nothing loads before it is asked for.
"""

from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

Made = TypeVar("Made")


class View(Generic[Made]):
    """A function whose body depends on the class of its first argument.

    Args:
        verb: what it does, for the message where nobody does it.

    Attributes:
        makers: the function for each class, as ``module:name`` both.
    """

    def __init__(self, verb: str) -> None:
        self._verb = verb
        self.makers: dict[str, str] = {}

    def __call__(self, thing: object, *args: Any, **options: Any) -> Made:
        """The view of a thing.

        Raises:
            TypeError: nobody makes one of it.
        """
        for kind in type(thing).__mro__:
            maker = self.makers.get(f"{kind.__module__}:{kind.__qualname__}")
            if maker is not None:
                made: Made = resolve_name(maker)(thing, *args, **options)
                return made
        raise TypeError(f"nothing {self._verb} a {type(thing).__name__}")


picture: View["Figure"] = View("draws")
curve: View["Figure"] = View("draws a curve of")
thumbnail: View["Figure"] = View("draws a thumbnail of")
section: View["Figure"] = View("cuts")
animation: View[None] = View("animates")
files: View["Path"] = View("writes files of")
series: View["Path"] = View("writes a series of")
scene: View["Path"] = View("makes a scene of")
