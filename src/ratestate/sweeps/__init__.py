"""Sweeps of any size: divided into chunks, spread over cores or a cluster, kept in a store.

=========================================== ======================================================
``sweep``                                   the function `sweep`
``calls``, ``chunks``, ``chunk_size``       what can be swept, how it is divided, what a case costs
``solve``, ``task``                         all cases of a part; chunks, solved and stored
``cluster``, ``subprocesses``               chunks on a cluster; those that may kill it
``connect``, ``slurm``, ``slurm_jobs``      Dask clusters, those made of SLURM jobs, and the jobs
``create``, ``store``, ``inputs``, ``lock`` a store: made, read and written, for one sweep at a time
``manifest``, ``origin``, ``legacy``        what its files must hold, what made them, and stores of
                                            older versions, which do not record this
``resume``, ``status``                      going on with a store; what a store or a result holds
``progress``                                the progress bar
``messages.toml``                           sentences on what goes wrong, filled in by `sentence`
=========================================== ======================================================
"""

from pathlib import Path

from ..model.sentences import Sentences

sentence = Sentences(Path(__file__).with_name("messages.toml"))
