"""The server.

================== ==================================================================
``server``         port, address, browser, end
``app``            page and WebSocket, for this machine's browser only; how many pages
``impatient``      HTTP of the server: half-open connections are closed
``session``        one page's questions into queues, the answers back
``question_queue`` questions of one kind in order; the oldest drop out
``kernels``        kernels of each law, form of friction, ..., loaded before the first answer
``upload``         the file of a laboratory's record, from the page into memory
================== ==================================================================
"""
