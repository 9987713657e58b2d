# Each target sets up .venv by itself; nothing but python3 >= 3.11 is needed on PATH.
# Another interpreter: make setup PYTHON=python3.13. Options for pytest: make test ARGS="-k march".

PYTHON ?= python3
UV_VERSION := 0.13.9
BUILD := tools/build.lock
BIN := .venv/bin
UV := UV_COMPILE_BYTECODE=1 VIRTUAL_ENV=.venv $(BIN)/uv --quiet --no-config

# Bytecode is kept, or each process that a test starts would compile all modules anew.
export PYTHONDONTWRITEBYTECODE :=

.PHONY: help setup figures explore test check docs cuda lowest newest wheel dist browser bench statistics torture mutants slurm lock clean
.DEFAULT_GOAL := help

help: ## show these targets
	@sed -n 's/^\([a-z]*\):.*## /  make \1	/p' Makefile

setup: .venv/.ready ## make .venv ready: the locked dependencies, and ratestate itself, editable

figures: .venv/.ready ## draw every figure of the paper, slip and aging law, into figures/
	$(BIN)/ratestate figures all --law slip --out figures
	$(BIN)/ratestate figures all --law aging --out figures

explore: .venv/.ready ## open the explorer in the browser; ARGS="--port 8000 --no-browser"
	$(BIN)/ratestate explore $(ARGS)

test: .venv/.ready ## run the tests on 2 processes
	$(BIN)/pytest -n 2 $(ARGS)

check: .venv/.docs ## lint, formatting, types, direction of imports, names, docstrings, English
	$(BIN)/ruff check
	$(BIN)/ruff format --check
	$(BIN)/mypy
	$(BIN)/lint-imports
	$(BIN)/python tools/check_imports.py
	$(BIN)/python tools/check_words.py
	$(BIN)/python tools/check_prose.py
	$(BIN)/python tools/check_docstrings.py

docs: .venv/.docs ## build the documentation, its code executed and its links checked, into build/docs
	$(BIN)/sphinx-build --quiet --jobs 2 --nitpicky --fail-on-warning --keep-going docs build/docs/html
	$(BIN)/python tools/check_links.py build/docs/html
	$(BIN)/python tools/run_code.py README.md docs/*.md docs/*/*.md

cuda: .venv/.ready ## assemble the kernels for NVIDIA GPUs, of which none is needed; installs 120 MB
	$(UV) venv --quiet --clear build/cuda
	$(UV) pip install --quiet --python build/cuda/bin/python nvidia-cuda-nvcc-cu12==12.9.86
	PTXAS=$$(find $(CURDIR)/build/cuda -name ptxas) $(BIN)/pytest -n 2 tests/engine/test_cuda.py -k assembler $(ARGS)

# Tests that use the dependencies most.
QUICK := tests/files/test_files.py tests/sweeps/test_store.py tests/model \
    tests/explorer/test_impatient.py

lowest: .venv/.uv-$(UV_VERSION) ## run some tests with the lowest versions that pyproject.toml admits
	$(UV) venv --quiet --clear build/lowest
	$(UV) pip install --quiet --python build/lowest/bin/python --resolution lowest-direct --build-constraint $(BUILD) -e '.[test]'
	build/lowest/bin/python -m pytest -n 2 -W default $(QUICK) $(ARGS)

newest: .venv/.uv-$(UV_VERSION) ## run the same tests with the newest versions, whatever the lock says
	$(UV) venv --quiet --clear build/newest
	$(UV) pip install --quiet --python build/newest/bin/python --upgrade --build-constraint $(BUILD) -e '.[test]'
	build/newest/bin/python -m pytest -n 2 $(QUICK) $(ARGS)

wheel: .venv/.uv-$(UV_VERSION) ## build the wheel and the sdist, and try each in an empty environment
	$(BIN)/python tools/try_wheel.py

dist: .venv/.uv-$(UV_VERSION) ## what a release publishes, tried, into dist/; ARGS="--tag v1.2.3" to insist on a version
	$(BIN)/python tools/make_dist.py $(ARGS)

browser: ## install Debian's headless chromium for the explorer's tests, where there is none
	tools/chromium.sh

bench: .venv/.ready ## run the benchmark
	$(BIN)/python benchmarks/run.py $(ARGS)

statistics: .venv/.ready ## run the tests that fit or evaluate hundreds of records
	$(BIN)/pytest -n 2 -m statistics $(ARGS)

torture: .venv/.ready ## kill a sweep 30 times, and see that nothing is lost; ARGS="--kills 100 --seed 1"
	$(BIN)/python tools/torture.py $(ARGS)

mutants: .venv/.ready ## see which random mutants of the source the tests kill; ARGS="--count 100 --seed 13 --jobs 2"
	$(BIN)/python tools/mutants.py $(ARGS)

slurm: .venv/.ready ## sweep in jobs of a real SLURM, which cancels some; needs Debian's slurm-wlm and munge
	$(BIN)/python tools/slurm.py $(ARGS)

COMPILE := pip compile --universal --python-version 3.11 --fork-strategy fewest \
    --generate-hashes --no-emit-index-url --no-emit-find-links --custom-compile-command "make lock"

lock: .venv/.uv-$(UV_VERSION) ## bring the three lock files up to pyproject.toml; newest versions: ARGS=--upgrade
	$(UV) $(COMPILE) pyproject.toml --extra test --extra check --extra bench --output-file requirements.lock $(ARGS)
	$(UV) $(COMPILE) pyproject.toml --extra docs --constraint requirements.lock --output-file docs/requirements.lock $(ARGS)
	$(UV) $(COMPILE) --group build --output-file $(BUILD) $(ARGS)

clean: ## remove .venv, caches, figures and builds
	rm -rf .venv .hypothesis .import_linter_cache .mypy_cache .pytest_cache .ruff_cache
	rm -rf build dist figures
	find src tests benchmarks -name __pycache__ -prune -exec rm -rf {} + 2> /dev/null || true

# The venv in three steps, each with its stamp: uv, the locked dependencies, ratestate.
.venv/.uv-$(UV_VERSION):
	@command -v $(PYTHON) > /dev/null || { echo "error: no $(PYTHON) on PATH; ratestate needs Python 3.11 or newer" >&2; exit 1; }
	@$(PYTHON) -c 'import sys; sys.version_info >= (3, 11) or sys.exit("error: ratestate needs Python 3.11 or newer, and $(PYTHON) is %d.%d; name another: make PYTHON=python3.13" % sys.version_info[:2])'
	@$(PYTHON) -c 'import ensurepip, venv' 2> /dev/null || { echo "error: $(PYTHON) has no venv module; on Debian and Ubuntu: apt install python3-venv" >&2; exit 1; }
	$(PYTHON) -m venv --clear .venv
	$(BIN)/python -m pip --quiet --disable-pip-version-check install --require-hashes -r $(BUILD)
	@touch $@

.venv/.locked: requirements.lock .venv/.uv-$(UV_VERSION)
	$(UV) pip install --require-hashes -r requirements.lock
	@touch $@

.venv/.docs: docs/requirements.lock .venv/.ready
	$(UV) pip install --require-hashes -r docs/requirements.lock
	@touch $@

.venv/.ready: pyproject.toml .venv/.locked
	$(UV) pip install --no-deps --build-constraint $(BUILD) -e .
	@touch $@
