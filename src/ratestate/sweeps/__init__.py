"""Sweeps of any size: divided into chunks, spread over cores or a cluster, kept in a store.

====================== ===========================================================================
``sweep``              the function `sweep`
``calls``, ``chunks``  functions that can be swept; how a sweep is divided
``solve``, ``tasks``   all cases of a chunk; chunks on threads or on a worker
``cluster``, ``slurm`` chunks on a Dask cluster; a Dask cluster made of SLURM jobs
``inputs``             arguments and origin of a sweep, compared before a store is resumed
``store``, ``writing`` a store: its states and how it is read; how it is made and written
``status``             how much of a sweep a store holds
``progress``           the progress bar
``messages.toml``      messages, filled in by `sentence`
====================== ===========================================================================
"""

from pathlib import Path

from ..model.names import Sentences

sentence = Sentences(Path(__file__).with_name("messages.toml"))
