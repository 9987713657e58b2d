"""Motion under any loading: `simulate`, its checks, and the batch that the engine runs."""
