"""Progress on a terminal."""

from __future__ import annotations

import sys

from ._flows import Report


def reporter(progress: bool | Report) -> Report:
    """What is told of progress: nothing, a bar, or the caller's own function of done and total."""
    if callable(progress):
        return progress
    return _bar() if progress else lambda done, total: None


def _bar() -> Report:
    try:
        from tqdm import tqdm
    except ImportError:
        return lambda done, total: print(f"\r{done} of {total}", end="\n" if done == total else "", file=sys.stderr)
    bar = tqdm(unit="")

    def report(done: int, total: int) -> None:
        bar.total = total
        bar.update(done - bar.n)
        if done >= total:
            bar.close()

    return report
