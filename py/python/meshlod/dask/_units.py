"""Tasks of a plan in portions that are worth sending to a worker."""

from __future__ import annotations

from collections.abc import Sequence

#: Number of faces up to which all tiles below one are made in one go. Dask takes some milliseconds
#: for a task; a tile of so many faces takes a hundred times as long.
SMALL = 50_000


class Units:
    """Tasks that are to do, in portions, and what these need.

    A portion is a tile with all that is below it, down to larger tiles, which are portions of their
    own. Of ``parts``, a list for each task of those that it needs, each has lesser numbers.
    ``faces`` is the greatest number of a leaf.
    """

    def __init__(self, parts: Sequence[Sequence[int]], done: Sequence[bool], faces: int) -> None:
        unit_of, parent = self._divide(parts, faces)
        tasks: dict[int, list[int]] = {}
        for task, unit in enumerate(unit_of):
            tasks.setdefault(unit, []).append(task)
        #: By portion: its tasks in order. A portion has the number of its last task.
        self.tasks = {unit: own for unit, own in tasks.items() if not all(done[t] for t in own)}
        #: Portions that are to do.
        self.left = set(self.tasks)
        #: By portion: its place if each comes right after those that it needs.
        self.place = {unit: at for at, unit in enumerate(_deep_first(parts)) if unit in self.tasks}
        self._above = {unit: unit_of[parent[unit]] for unit in self.tasks if parent[unit] >= 0}
        self._needs = dict.fromkeys(self.tasks, 0)
        for above in self._above.values():
            if above in self._needs:
                self._needs[above] += 1

    @staticmethod
    def _divide(parts: Sequence[Sequence[int]], faces: int) -> tuple[list[int], list[int]]:
        """Returns the portion that each task is in, and the task that needs it; -1 for none."""
        parent = [-1] * len(parts)
        leaves: list[int] = []
        for task, own in enumerate(parts):
            leaves.append(sum(leaves[part] for part in own) or 1)
            for part in own:
                parent[part] = task
        unit_of = list(range(len(parts)))
        for task in reversed(range(len(parts))):
            if parent[task] >= 0 and leaves[task] * faces < SMALL:
                unit_of[task] = unit_of[parent[task]]
        return unit_of, parent

    def ready(self) -> list[int]:
        """Returns the portions that need no other one, in order."""
        free = [unit for unit, needs in self._needs.items() if needs == 0]
        return sorted(free, key=self.place.__getitem__)

    def finish(self, unit: int) -> list[int]:
        """Notes that a portion is done; returns those that have waited for it alone."""
        self.left.discard(unit)
        above = self._above.get(unit, -1)
        if above not in self._needs:
            return []
        self._needs[above] -= 1
        return [above] if self._needs[above] == 0 else []


def _deep_first(parts: Sequence[Sequence[int]]) -> list[int]:
    """Returns the tasks so that each comes right after those that it needs."""
    order: list[int] = []
    waiting = [len(parts) - 1]
    while waiting:
        task = waiting.pop()
        order.append(task)
        waiting.extend(parts[task])
    return order[::-1]
