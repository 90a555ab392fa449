"""Validation of arrays, and their exchange with the program as ``.npy`` files."""

from __future__ import annotations

import csv
import os
from collections.abc import Callable, Collection, Sequence
from typing import Any, TypeVar

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.integer[Any]]

#: Input with a number in each row: an array or a list.
Column = npt.NDArray[Any] | Sequence[float]
#: Input with a fixed number of columns: an array, a list of lists, a list of arrays.
Rows = npt.NDArray[Any] | Sequence[Collection[Any]]


_Kind = TypeVar("_Kind", bound=Array)


def _shown(row: Any) -> str:
    return str(np.asarray(row).tolist())


def _array(name: str, values: Any, columns: int | None, rows: tuple[str, int] | None) -> Array:
    array = np.asarray(values)
    wanted = f"(n, {columns})" if columns else "(n,)"
    if array.ndim != (2 if columns else 1) or (columns and array.shape[1] != columns):
        # The shape of an empty list does not matter.
        if array.size or (array.ndim == 2 and columns and array.shape[1] not in (0, columns)):
            raise ValueError(f"{name}: the shape is {array.shape}: give an array of shape {wanted}")
        array = array.reshape((0, columns) if columns else (0,))
    if rows is not None and len(array) != rows[1]:
        raise ValueError(f"{name}: there are {len(array)} rows: give one for each of the {rows[1]} rows of {rows[0]}")
    return array


def floats(name: str, values: Any, columns: int | None = None, rows: tuple[str, int] | None = None) -> Floats:
    """Validates finite numbers and returns them as float64."""
    array = _array(name, values, columns, rows)
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name}: the dtype is {array.dtype}: give real numbers")
    array = array.astype(np.float64, copy=False)
    bad = ~np.isfinite(array)
    if bad.any():
        row = int(np.argmax(bad.any(axis=1) if columns else bad))
        raise ValueError(f"{name}: row {row} is {_shown(array[row])}: give finite numbers")
    return array


def ints(name: str, values: Any, columns: int | None = None, rows: tuple[str, int] | None = None) -> Ints:
    """Validates integers of any width."""
    array = _array(name, values, columns, rows)
    if not array.size:
        array = array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise ValueError(f"{name}: the dtype is {array.dtype}: give integers")
    return array


def labels(name: str, values: Any, rows: tuple[str, int]) -> Ints:
    """Validates one integer of 32 bits for each row of another array."""
    array = ints(name, values, None, rows)
    wide = (array < -(2**31)) | (array >= 2**31)
    if wide.any():
        row = int(np.argmax(wide))
        raise ValueError(f"{name}: row {row} is {array[row]}: give an integer of 32 bits")
    return array.astype(np.int32, copy=False)


def indices(name: str, values: Any, columns: int | None, of: str, count: int) -> Ints:
    """Validates indices into the ``count`` rows of the array ``of``."""
    array = ints(name, values, columns)
    outside = (array < 0) | (array >= count)
    if outside.any():
        row = int(np.argmax(outside.any(axis=1) if columns else outside))
        named = array[row][outside[row]][0] if columns else array[row]
        raise ValueError(f"{name}: row {row} refers to row {named} of {of}, which has {count} rows, counted from 0")
    return array


def write(folder: str, **arrays: Array | None) -> None:
    """Writes each array that is not None as ``NAME.npy``."""
    for name, array in arrays.items():
        if array is not None:
            np.save(os.path.join(folder, f"{name}.npy"), np.ascontiguousarray(array), allow_pickle=False)


def read(folder: str, name: str) -> Array:
    """Maps an array that the program has written; changes to it do not reach the file."""
    path = os.path.join(folder, f"{name}.npy")
    try:
        return np.asarray(np.load(path, mmap_mode="c", allow_pickle=False))
    except ValueError:
        # An empty array cannot be mapped.
        array: Array = np.load(path, allow_pickle=False)
        return array


def optional(validate: Callable[..., _Kind], name: str, values: Any, *more: Any) -> _Kind | None:
    """Validates an array that may be None."""
    return None if values is None else validate(name, values, *more)


def columns(path: str) -> dict[str, Any]:
    """The columns of a table: numbers where all values are, else texts. Empty values are NaN."""
    with open(path, newline="", encoding="utf-8") as file:
        names, *rows = csv.reader(file)
    found: dict[str, Any] = {}
    for name, column in zip(names, zip(*rows) if rows else [()] * len(names)):
        try:
            found[name] = np.array([float(value) if value else np.nan for value in column])
        except ValueError:
            found[name] = np.array(column)
    return found
