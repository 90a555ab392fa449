"""Arrays on their way to the program and back: looked at first, mapped afterwards."""

from __future__ import annotations

import os
from typing import Any

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[Any]
Floats = npt.NDArray[np.float64]
Ints = npt.NDArray[np.integer[Any]]


def _shown(row: Any) -> str:
    return str(np.asarray(row).tolist())


def _array(name: str, values: Any, columns: int | None, rows: tuple[str, int] | None) -> Array:
    array = np.asarray(values)
    wanted = f"(n, {columns})" if columns else "(n,)"
    if array.ndim != (2 if columns else 1) or (columns and array.shape[1] != columns):
        # Of a list with nothing in it the shape says nothing.
        if array.size or (array.ndim == 2 and columns and array.shape[1] not in (0, columns)):
            raise ValueError(f"{name}: has the shape {array.shape}, and {wanted} is needed")
        array = array.reshape((0, columns) if columns else (0,))
    if rows is not None and len(array) != rows[1]:
        raise ValueError(f"{name}: has {len(array)} rows, and {rows[0]} has {rows[1]}: there has to be one for each")
    return array


def floats(name: str, values: Any, columns: int | None = None, rows: tuple[str, int] | None = None) -> Floats:
    """Finite numbers, as float64."""
    array = _array(name, values, columns, rows)
    if array.dtype.kind not in "fiu":
        raise ValueError(f"{name}: has the dtype {array.dtype}, and real numbers are needed")
    array = array.astype(np.float64, copy=False)
    bad = ~np.isfinite(array)
    if bad.any():
        row = int(np.argmax(bad.any(axis=1) if columns else bad))
        raise ValueError(f"{name}: row {row} is {_shown(array[row])}, which is infinite or not a number")
    return array


def ints(name: str, values: Any, columns: int | None = None, rows: tuple[str, int] | None = None) -> Ints:
    """Integers of any width."""
    array = _array(name, values, columns, rows)
    if not array.size:
        array = array.astype(np.int64)
    if array.dtype.kind not in "iu":
        raise ValueError(f"{name}: has the dtype {array.dtype}, and integers are needed")
    return array


def labels(name: str, values: Any, rows: tuple[str, int]) -> Ints:
    """An integer of 32 bits for each row of something else."""
    array = ints(name, values, None, rows)
    wide = (array < -(2**31)) | (array >= 2**31)
    if wide.any():
        row = int(np.argmax(wide))
        raise ValueError(f"{name}: row {row} is {array[row]}, which does not fit into 32 bits")
    return array.astype(np.int32, copy=False)


def indices(name: str, values: Any, columns: int | None, of: str, count: int) -> Ints:
    """Rows that name those of another array, which has ``count``."""
    array = ints(name, values, columns)
    outside = (array < 0) | (array >= count)
    if outside.any():
        row = int(np.argmax(outside.any(axis=1) if columns else outside))
        named = array[row][outside[row]][0] if columns else array[row]
        raise ValueError(f"{name}: row {row} names {named}, but {of} has {count} rows, the first is 0")
    return array


def write(folder: str, **arrays: Array | None) -> None:
    """Writes those that are there, each as ``NAME.npy``."""
    for name, array in arrays.items():
        if array is not None:
            np.save(os.path.join(folder, f"{name}.npy"), np.ascontiguousarray(array), allow_pickle=False)


def read(folder: str, name: str) -> Array:
    """An array that the program has written, mapped: what is changed in it changes no file."""
    path = os.path.join(folder, f"{name}.npy")
    try:
        return np.asarray(np.load(path, mmap_mode="c", allow_pickle=False))
    except ValueError:
        # What has no bytes cannot be mapped.
        array: Array = np.load(path, allow_pickle=False)
        return array
