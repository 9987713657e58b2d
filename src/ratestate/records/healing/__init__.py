"""Frictional healing in slide-hold-slide tests."""
