"""Sweeps of any size: divided into chunks, spread over cores or a cluster, kept in a store.

=========================================== ======================================================
``sweep``                                   the function `sweep`
``calls``, ``chunks``, ``chunk_size``       what can be swept, how it is divided, what a case costs
``solve``, ``task``                         all cases of a part; chunks, also on threads
``request``                                 what is swept, divided into chunks, for a store or not
``cluster``, ``cluster_work``               chunks on a cluster, tried again when workers die; its
                                            tasks under way
``subprocesses``                            such chunks in a child process
``backends``                                who computes: threads, a client's cluster, or jobs
``job_cluster``, ``jobs``                   Dask clusters made of jobs, and the jobs
``slurm``                                   the batch system of such jobs
``create``, ``store``, ``inputs``, ``lock`` a store: made, read and written, for one sweep at a time
``writing``                                 chunks written into it
``record``, ``manifest``, ``origin``        what it says of itself: flaws, files, what made them
``legacy``                                  stores of older versions, which do not record this
``resume``, ``status``                      going on with a store; what a store or a result holds
``progress``                                the progress bar
``messages.toml``                           sentences on what goes wrong, filled in by `sentence`
=========================================== ======================================================
"""

from pathlib import Path

from ..model.names import Sentences

sentence = Sentences(Path(__file__).with_name("messages.toml"))
