"""The Makefile's test, check and bench in environments of their own: nox, or nox -s tests-3.13."""

import nox

PYTHONS = ["3.11", "3.12", "3.13", "3.14"]
nox.needs_version = ">=2024.4.15"
nox.options.default_venv_backend = "uv|virtualenv"


def install(session: nox.Session) -> None:
    session.install("--require-hashes", "-r", "requirements.lock")
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
def bench(session: nox.Session) -> None:
    """Run the benchmark."""
    install(session)
    session.run("python", "benchmarks/run.py", *session.posargs)
