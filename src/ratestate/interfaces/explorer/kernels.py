"""The kernels of each friction law, loaded or compiled once, before a page is answered."""

import asyncio
import contextlib

from ...engine.backend import Stopped
from .budget import Deadline

#: seconds that it may take: on some machines kernels are compiled
SECONDS = 300.0


class Kernels:
    """Which laws are ready; `warm_up` (law, deadline) makes one so, in a thread of the pool."""

    def __init__(self, pool, warm_up):
        self.pool, self.warm_up = pool, warm_up
        self.deadline = Deadline(SECONDS)
        self.tasks: dict[str, asyncio.Task] = {}

    def are_ready(self, law):
        """Whether the kernels of a law are loaded."""
        return law in self.tasks and self.tasks[law].done()

    async def prepare(self, law):
        """Wait until the kernels of a law are loaded."""
        if law not in self.tasks:
            self.tasks[law] = asyncio.create_task(self._load(law))
        await asyncio.shield(self.tasks[law])

    async def _load(self, law):
        loop = asyncio.get_running_loop()
        with contextlib.suppress(Stopped):
            await loop.run_in_executor(self.pool, self.warm_up, law, self.deadline)

    def close(self):
        """End all preparations."""
        self.deadline.set()
        for task in self.tasks.values():
            task.cancel()
