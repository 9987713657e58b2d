"""The kernels of each kind of slider, loaded or compiled once, before a page is answered."""

import asyncio
import contextlib
from typing import NamedTuple

from ....engine.backend import Stopped
from ..computation.budget import Deadline

#: seconds that it may take: on some machines kernels are compiled
SECONDS = 300.0


class Kind(NamedTuple):
    """What decides which kernels a page needs."""

    law: str
    friction: str
    own: tuple[str, ...]  # symbols of the parameters that law, friction and damping bring
    sigma_varies: bool


def kind_of(state):
    """The `Kind` of a `PageState`."""
    slider = state.slider
    own = tuple(slider.friction_law.parameters)
    return Kind(slider.law, slider.friction, own, state.sigma_varies)


class Kernels:
    """Which kinds are ready; `warm_up` (kind, deadline) makes one so, in a thread of the pool."""

    def __init__(self, pool, warm_up):
        self.pool, self.warm_up = pool, warm_up
        self.deadline = Deadline(SECONDS)
        self.tasks: dict[Kind, asyncio.Task] = {}

    def are_ready(self, kind):
        """Whether the kernels of a kind are loaded."""
        return kind in self.tasks and self.tasks[kind].done()

    async def prepare(self, kind):
        """Wait until the kernels of a kind are loaded."""
        if kind not in self.tasks:
            self.tasks[kind] = asyncio.create_task(self._load(kind))
        await asyncio.shield(self.tasks[kind])

    async def _load(self, kind):
        loop = asyncio.get_running_loop()
        with contextlib.suppress(Stopped):
            await loop.run_in_executor(self.pool, self.warm_up, kind, self.deadline)

    def close(self):
        """End all preparations."""
        self.deadline.set()
        for task in self.tasks.values():
            task.cancel()
