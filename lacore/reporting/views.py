"""Views of results: picture, section, film, files, scene.

Results depend neither on matplotlib nor on meshio, nor on the modules that use them:
`lacore.pictures` registers the function for each view and class. Both are given by name and
imported on first use.
"""

from pkgutil import resolve_name
from typing import TYPE_CHECKING, Any, Generic, TypeVar

if TYPE_CHECKING:
    from pathlib import Path

    from matplotlib.figure import Figure

Made = TypeVar("Made")


class View(Generic[Made]):
    """Function whose body depends on the class of its first argument.

    Args:
        verb: its action, for the message if there is no function.

    Attributes:
        makers: function for each class, both as ``module:name``.
    """

    def __init__(self, verb: str) -> None:
        self._verb = verb
        self.makers: dict[str, str] = {}

    def __call__(self, thing: object, *args: Any, **options: Any) -> Made:
        """Return the view of an object.

        Raises:
            TypeError: there is no function for its class.
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
