"""How far a run is."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple


class Progress(NamedTuple):
    """So much of a stage is done, in units of its own; ``total`` is 0 where it is not known."""

    stage: str
    done: int
    total: int

    @property
    def fraction(self) -> float | None:
        """The share of the stage that is done, from 0 to 1; None where that is not known."""
        return min(self.done / self.total, 1.0) if self.total else None


#: What ``progress=`` takes: a function that is called with each :class:`Progress`, True for bars of tqdm, False for none.
ProgressLike = bool | Callable[[Progress], Any] | None


class _Bars:
    """A bar of tqdm for each stage, one after the other."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError as error:
            raise ImportError("progress=True shows bars of tqdm: pip install tqdm, or give a function instead") from error
        self._tqdm: Any = tqdm
        self._bar: Any = None
        self._stage: str | None = None

    def __call__(self, progress: Progress) -> None:
        if progress.stage != self._stage:
            self.close()
            self._stage = progress.stage
            self._bar = self._tqdm(desc=progress.stage, total=progress.total or None)
        if progress.total:
            self._bar.total = progress.total
        self._bar.update(max(0, progress.done - self._bar.n))

    def close(self) -> None:
        if self._bar is not None:
            self._bar.close()
            self._bar = None


def listener(progress: ProgressLike) -> tuple[Callable[[Progress], Any] | None, Callable[[], None]]:
    """What is called with each progress, and what is called in the end."""
    if progress is True:
        bars = _Bars()
        return bars, bars.close
    if progress is None or progress is False:
        return None, lambda: None
    if not callable(progress):
        raise TypeError(f"progress is {progress!r}; give a function, True for bars of tqdm, or False")
    return progress, lambda: None
