"""Stores on disks that take no time."""

import os

import pytest


@pytest.fixture(autouse=True)
def quick(monkeypatch):
    """No waiting for the disk: what it is asked for, and when, has a test of its own."""
    monkeypatch.setattr(os, "fsync", lambda handle: None)
