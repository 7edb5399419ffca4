"""The exception and the warning of the package."""

import warnings

from ._native import MeshlodError

__all__ = ["MeshlodError", "MeshlodWarning", "warn"]


class MeshlodWarning(UserWarning):
    """Something was left out or changed on the way, or a target was missed."""


def warn(text: str) -> None:
    """Warns at the line outside the package that called it."""
    # From here through the public function of the package to its caller.
    warnings.warn(text, MeshlodWarning, stacklevel=3)
