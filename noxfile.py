#!/usr/bin/env -S uv run --script
# /// script
# dependencies = ["nox"]
# ///
"""The Makefile's targets in environments of their own: nox, or nox -s tests-3.13."""

import nox

PYTHONS = ["3.11", "3.12", "3.13", "3.14"]
nox.needs_version = ">=2024.4.15"
nox.options.default_venv_backend = "uv|virtualenv"


def install(session: nox.Session, lock: str = "requirements.lock") -> None:
    session.install("--require-hashes", "-r", lock)
    session.install("--no-deps", "-e", ".")


@nox.session(python=PYTHONS)
def tests(session: nox.Session) -> None:
    """Run the tests; arguments after -- go to pytest."""
    install(session)
    session.run("pytest", "-n", "2", *session.posargs)


@nox.session
def check(session: nox.Session) -> None:
    """Lint, formatting, types, direction of imports."""
    install(session)
    session.run("ruff", "check")
    session.run("ruff", "format", "--check")
    session.run("mypy")
    session.run("lint-imports")


@nox.session(default=False)
def docs(session: nox.Session) -> None:
    """Build the documentation; its notebooks are executed, and warnings are errors."""
    install(session, "docs/requirements.lock")
    pages = "build/docs/html"
    strict = ["--nitpicky", "--fail-on-warning", "--keep-going"]
    session.run("sphinx-build", "--quiet", *strict, "docs", pages)
    session.run("python", "tools/check_links.py", pages)


@nox.session(default=False)
def wheel(session: nox.Session) -> None:
    """Build the wheel and the source distribution, and use each in an empty environment."""
    session.install("--require-hashes", "-r", "tools/build.lock")
    session.run("python", "tools/try_wheel.py")


@nox.session(default=False)
def bench(session: nox.Session) -> None:
    """Run the benchmark."""
    install(session)
    session.run("python", "benchmarks/run.py", *session.posargs)


if __name__ == "__main__":
    nox.main()
