"""Stores on disks that take no time; a limit of time."""

import os
import signal

import pytest


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """No waiting for the disk: what it is asked for, and when, has a test of its own."""
    monkeypatch.setattr(os, "fsync", lambda handle: None)


@pytest.fixture
def in_time():
    """Let a test that hangs fail."""

    def late(*_):
        raise TimeoutError("this takes too long")

    before = signal.signal(signal.SIGALRM, late)
    signal.alarm(150)
    yield
    signal.alarm(0)
    signal.signal(signal.SIGALRM, before)
