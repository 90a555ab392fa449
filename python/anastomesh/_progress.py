"""Progress of a run."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple


class Progress(NamedTuple):
    """Progress of a stage: ``done`` of ``total`` units; ``total`` is 0 if it is unknown."""

    stage: str
    done: int
    total: int

    @property
    def fraction(self) -> float | None:
        """Share of the stage that is done, from 0 to 1, or None if it is unknown."""
        return min(self.done / self.total, 1.0) if self.total else None


#: Values of ``progress=``: a function that gets each :class:`Progress`, True for progress bars of tqdm, or False.
ProgressLike = bool | Callable[[Progress], Any] | None


class _Bars:
    """Progress bars of tqdm, one for each stage."""

    def __init__(self) -> None:
        try:
            from tqdm.auto import tqdm
        except ImportError as error:
            raise ImportError("progress=True needs tqdm: pip install tqdm, or give a function instead") from error
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
    """Function that gets each progress, and function that is called at the end."""
    if progress is True:
        bars = _Bars()
        return bars, bars.close
    if progress is None or progress is False:
        return None, lambda: None
    if not callable(progress):
        raise TypeError(f"progress={progress!r}: give a function, True for progress bars, or False")
    return progress, lambda: None
