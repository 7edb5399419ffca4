"""Arrays as callers have them, made contiguous and of the types that the native part takes.

An array that is so already is not copied here.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike, DTypeLike, NDArray

from ._errors import MeshlodError

#: Greatest whole number that single precision holds with all its predecessors.
MOST_LABEL = 2**24

#: An attribute for the native part: name, kind, values.
Attribute = tuple[str, str, NDArray[np.float32]]

#: Layout that Rust can read in place: row after row, at aligned addresses.
ALIGNED: tuple[Literal["C"], Literal["A"]] = ("C", "A")


def as_points(points: ArrayLike, name: str = "points") -> NDArray[Any]:
    """Returns points as rows of three floats, of single or double precision."""
    array = as_array(points, name)
    if array.size == 0 and array.ndim < 2:
        array = array.reshape(0, 3)
    _check_rows(array, name, (3,))
    if array.dtype.kind not in "fiu":
        raise MeshlodError(f"{name} must be numbers, not {array.dtype}")
    single = array.dtype.kind == "f" and array.dtype.itemsize == 4
    return np.require(array, np.float32 if single else np.float64, ALIGNED)


def as_rows(
    values: ArrayLike, name: str, dtype: DTypeLike, count: int | None = None
) -> NDArray[Any]:
    """Returns rows of three numbers, ``count`` of them if that is given, of a type."""
    array = as_points(values, name)
    if count is not None and len(array) != count:
        raise MeshlodError(f"{name} has {len(array)} rows, but there are {count} positions")
    return np.require(array, dtype, ALIGNED)


def as_column(values: ArrayLike, name: str, count: int) -> NDArray[Any]:
    """Returns ``count`` numbers."""
    array = as_array(values, name)
    if array.shape != (count,) or array.dtype.kind not in "fiu":
        shape, dtype = array.shape, array.dtype
        raise MeshlodError(f"{name} must have the shape ({count},), not {dtype} of {shape}")
    return array


def as_faces(faces: ArrayLike, name: str = "faces") -> NDArray[Any]:
    """Returns faces as rows of three integers of 32 or 64 bits."""
    array = as_array(faces, name)
    if array.size == 0:
        if array.ndim >= 2:
            _check_rows(array, name, (3,))
        return np.zeros((0, 3), dtype=np.int32)
    _check_rows(array, name, (3,), hint="triangulate polygons first")
    if array.dtype.kind not in "iu":
        raise MeshlodError(f"{name} must be integers, not {array.dtype}")
    if array.dtype.kind == "u" and array.dtype.itemsize == 8:
        if array.max() > np.iinfo(np.int64).max:
            row = int(np.argmax(array.max(axis=1)))
            raise MeshlodError(f"{name}: row {row} has an index that is no index of a point")
        return np.require(array, np.int64, ALIGNED)
    if array.dtype.kind == "u" and array.dtype.itemsize == 4:
        return np.require(array, np.uint32, ALIGNED)
    return np.require(array, np.int64 if array.dtype.itemsize == 8 else np.int32, ALIGNED)


def as_attributes(
    count: int,
    normals: ArrayLike | None,
    uvs: ArrayLike | None,
    colors: ArrayLike | None,
    others: Mapping[str, ArrayLike] | None,
) -> list[Attribute]:
    """Returns the attributes of ``count`` points for the native part."""
    attributes: list[Attribute] = []
    if normals is not None:
        attributes.append(("normals", "normal", _unit(_floats(normals, "normals", count, (3,)))))
    if uvs is not None:
        attributes.append(("uvs", "uv", _floats(uvs, "uvs", count, (2,))))
    if colors is not None:
        attributes.append(("colors", "color", _colors(colors, count)))
    for name, values in as_named(others).items():
        if name in ("normals", "uvs", "colors"):
            raise MeshlodError(f"attributes: {name} has a parameter of its own")
        array = as_array(values, name)
        is_label = array.dtype.kind in "iub"
        if is_label and array.size and not -MOST_LABEL <= array.min() <= array.max() <= MOST_LABEL:
            raise MeshlodError(f"{name}: whole numbers must be at most {MOST_LABEL}")
        attributes.append((name, "label" if is_label else "other", _floats(array, name, count)))
    return attributes


def as_named(attributes: Mapping[str, ArrayLike] | None) -> Mapping[str, ArrayLike]:
    """Returns attributes by their names, none of which is empty."""
    if attributes is None:
        return {}
    if not isinstance(attributes, Mapping):
        kind = type(attributes).__name__
        raise MeshlodError(f"attributes must be a dictionary of names and arrays, not {kind}")
    for name in attributes:
        if not isinstance(name, str) or not name:
            what = "a string that is not empty"
            raise MeshlodError(f"attributes: a name must be {what}, not {name!r}")
    return attributes


def as_vertices(locks: ArrayLike, count: int) -> NDArray[np.int64]:
    """Returns the rows of ``count`` points that a mask or an array of rows selects."""
    array = as_array(locks, "locks")
    if array.size == 0 and array.dtype.kind != "b":
        return np.zeros(0, dtype=np.int64)
    if array.ndim != 1 or array.dtype.kind not in "biu":
        shape, dtype = array.shape, array.dtype
        raise MeshlodError(f"locks must be a mask or rows of points, not {dtype} of shape {shape}")
    if array.dtype.kind == "b":
        if len(array) != count:
            raise MeshlodError(f"locks: a mask of {len(array)} rows, but there are {count} points")
        return np.flatnonzero(array)
    for row in (array.min(), array.max()):
        if not 0 <= row < count:
            raise MeshlodError(f"locks: there is no point {row}, only {count}")
    return np.require(array, np.int64, ALIGNED)


def returned(
    attributes: list[tuple[str, NDArray[np.float32]]], given: Mapping[str, Any]
) -> dict[str, NDArray[Any]]:
    """Returns attributes by name, in the types and shapes of those that were given."""
    all_values: dict[str, NDArray[Any]] = {}
    for name, values in attributes:
        like = given.get(name)
        if like is not None:
            like = np.asarray(like)
            if name == "colors" and like.dtype == np.uint8:
                values = np.rint(values * 255).clip(0, 255)
            if like.dtype.kind == "f" or name not in ("normals", "uvs"):
                # Integers would round directions and texture coordinates away.
                values = values.astype(like.dtype, copy=False)
            if like.ndim == 1:
                values = values.reshape(-1)
        all_values[name] = values
    return all_values


def as_array(values: ArrayLike, name: str) -> NDArray[Any]:
    """Returns an array as it is."""
    if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
        raise MeshlodError(f"{name} has masked values: fill or drop them first")
    try:
        return np.asarray(values)
    except (TypeError, ValueError) as error:
        raise MeshlodError(f"{name} is no array: {error}") from None


def _check_rows(array: NDArray[Any], name: str, widths: tuple[int, ...], hint: str = "") -> None:
    if array.ndim != 2 or array.shape[1] not in widths:
        shape = " or ".join(f"(n, {width})" for width in widths)
        hint = f": {hint}" if hint else ""
        raise MeshlodError(f"{name} must have the shape {shape}, not {array.shape}{hint}")


def _floats(
    values: ArrayLike, name: str, count: int, widths: tuple[int, ...] = ()
) -> NDArray[np.float32]:
    array = as_array(values, name)
    if array.ndim == 1 and not widths:
        array = array.reshape(-1, 1)
    _check_rows(array, name, widths or (array.shape[-1] if array.ndim else 1,))
    if array.dtype.kind not in "fiub":
        raise MeshlodError(f"{name} must be numbers, not {array.dtype}")
    if len(array) != count:
        raise MeshlodError(f"{name} has {len(array)} rows, but there are {count} points")
    with np.errstate(over="ignore"):
        # What overflows is infinite, which is refused with its row.
        return np.require(array, np.float32, ALIGNED)


def _unit(normals: NDArray[np.float32]) -> NDArray[np.float32]:
    """Returns normals of unit length; those of no length stay."""
    lengths = np.linalg.norm(normals.astype(np.float64), axis=1, keepdims=True)
    if not np.all(np.isfinite(lengths)) or np.all(np.abs(lengths - 1) < 1e-4):
        return normals
    return (normals / np.where(lengths == 0, 1, lengths)).astype(np.float32)


def _colors(colors: ArrayLike, count: int) -> NDArray[np.float32]:
    array = as_array(colors, "colors")
    values = _floats(array, "colors", count, (3, 4))
    if array.dtype == np.uint8:
        return values / np.float32(255)
    if array.dtype.kind != "f":
        raise MeshlodError(f"colors must be floats from 0 to 1, or uint8, not {array.dtype}")
    return values


def by_name(
    layers: list[tuple[str, NDArray[np.float32]]],
) -> dict[str, NDArray[np.float32]]:
    """Returns attributes by name; those with a name that is taken get a number."""
    named: dict[str, NDArray[np.float32]] = {}
    for known, values in layers:
        name, number = known, 1
        while name in named:
            number += 1
            name = f"{known}-{number}"
        named[name] = values
    return named
