"""Sweeps of any size: cut in chunks, spread over cores or a cluster, kept in a store.

``verb`` has the function `sweep`.  ``calls``: what can be swept; ``chunks``: how it is cut;
``probe``: what a case costs; ``solve``: all cases of a part, each bad one by itself; ``task``: a
chunk solved and stored; ``here`` and ``cluster``: who does the tasks; ``connect``: how to come by a
cluster; ``apart``: cases that kill their process; ``create``, ``store``, ``lock`` and ``inputs``:
what is kept; ``manifest``: what each file must hold (``older``: without one); ``origin``: versions
and processor; ``resume``: what a store must be to be gone on with; ``status``: what a store or a
result holds; ``bar``: progress.
"""
