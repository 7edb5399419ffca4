"""Objects that never change."""

from __future__ import annotations

from typing import Any, NoReturn, SupportsIndex, TypeVar

from ._errors import MeshlodError

Self = TypeVar("Self", bound="Immutable")


class Immutable:
    """Base of objects that never change, so that their copies are they themselves."""

    __slots__ = ()

    def copy(self: Self) -> Self:
        """Returns the object itself, since it never changes."""
        return self

    def __copy__(self: Self) -> Self:
        return self

    def __deepcopy__(self: Self, memo: Any) -> Self:
        return self

    def __reduce_ex__(self, protocol: SupportsIndex) -> NoReturn:
        kind = type(self).__name__
        advice = "make it where it is needed, or pass the path of a file"
        raise MeshlodError(f"a {kind} cannot be pickled: {advice}")
