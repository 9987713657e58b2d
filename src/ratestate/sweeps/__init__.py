"""Sweeps of any size: divided into chunks, spread over cores or a cluster, kept in a store."""

from pathlib import Path

from ..model.names import Sentences

sentence = Sentences(Path(__file__).with_name("messages.toml"))
