"""Sweeps of any size: divided into chunks, spread over cores or a cluster, kept in a store.

==================== =============================================================================
``sweep``            the function `sweep`
``calls``, ``chunks``what can be swept; how it is divided
``solve``, ``tasks`` all cases of a part; chunks on threads, on workers or in a child process
``cluster``, ``slurm`` chunks on a Dask cluster; a Dask cluster made of SLURM jobs
``inputs``           what a sweep is begun with, compared before a store is resumed
``store``, ``writing`` a store: its states and how it is read; how it is made and written
``status``           how much of a sweep a store holds
``progress``         the progress bar
``messages.toml``    messages, filled in by `sentence`
==================== =============================================================================
"""

from pathlib import Path

from ..model.names import Sentences

sentence = Sentences(Path(__file__).with_name("messages.toml"))
