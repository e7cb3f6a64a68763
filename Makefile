.DEFAULT_GOAL := help
SHELL := /bin/sh
PYTHON ?= python3
BIN := .venv/bin
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check

# The environment is this folder's own, whatever the user's settings for others are.
export PIP_USER := 0
unexport PIP_TARGET PIP_PREFIX PYTHONPATH PYTHONHOME PYTHONDONTWRITEBYTECODE

# A moved or copied environment runs the code of where it was made, or nothing: it is made again.
RUNS := $(BIN)/python -I -c 'from importlib.util import find_spec; print(find_spec("bcre_studies").origin)'
ifneq ($(shell $(RUNS) 2>/dev/null),$(CURDIR)/studies/bcre_studies/__init__.py)
.PHONY: .venv/installed
CLEAR := --clear
endif

.PHONY: help install reports speed maps test test-cluster costs docs faults reference bench check lint clean

help: ## list the targets
	@awk -F ':.*## ' '/^[a-z-]+:.*## / { printf "  make %-13s %s\n", $$1, $$2 }' $(MAKEFILE_LIST)

install: .venv/installed ## create .venv with the locked dependencies

.venv/installed: requirements.lock pyproject.toml
	@"$(PYTHON)" -c 'import sys; sys.exit(sys.version_info < (3, 11))' || { echo 'Python 3.11 or newer is needed: make PYTHON=python3.11' >&2; exit 2; }
	"$(PYTHON)" -m venv $(CLEAR) .venv
	$(PIP) --no-compile --require-hashes -r requirements.lock
	$(PIP) --no-deps --no-build-isolation -e .
	@touch $@

reports: install ## run all studies, write reports/; time them here, into reports/local/
	$(BIN)/bcre report
	$(BIN)/bcre speed

speed: install ## renew the committed record of speed (some minutes, on a quiet machine)
	$(BIN)/bcre speed --record
	$(BIN)/bcre report

maps: install ## the agreement map from 200,000 scenes (hours; SCHEDULER=tcp://host:port: on a cluster)
	$(BIN)/python -c 'from bcre_studies.validation.agreement_map.fine import main; main()' $(if $(SCHEDULER),--scheduler $(SCHEDULER))

test: install ## run the tests; those of the page where Chromium is installed
	@! command -v chromium >/dev/null || $(BIN)/python -c 'import playwright' 2>/dev/null \
		|| $(PIP) --no-compile --require-hashes -r requirements-browser.lock \
		|| echo 'Playwright cannot be installed here: the page is not tried in a browser' >&2
	$(BIN)/python -m pytest

test-cluster: install ## run the sweeps' tests on a Dask scheduler with two workers on this machine
	@$(BIN)/python -c 'import distributed' 2>/dev/null \
		|| $(PIP) --require-hashes -r requirements-cluster.lock
	$(BIN)/python -m pytest -o addopts='--import-mode=importlib -q --strict-markers' -o python_files='cluster_*.py' -o 'pythonpath=tests/robustness tests/cluster' tests/cluster

costs: install ## measure what sweeps cost on workers and a scheduler (5 minutes), reports/quality/sweep_*.csv
	@$(BIN)/python -c 'import distributed' 2>/dev/null \
		|| $(PIP) --require-hashes -r requirements-cluster.lock
	$(BIN)/python tests/cluster/costs.py

docs: install ## build the documentation, docs/_build/index.html; a warning is an error
	@$(BIN)/python -c 'import furo, myst_parser, sphinx' 2>/dev/null \
		|| $(PIP) --require-hashes -r requirements-docs.lock
	$(BIN)/python -m sphinx -b html -q -W --keep-going docs docs/_build

faults: install ## try every fault again and write reports/quality/faults.csv
	$(BIN)/python tests/robustness/faults.py

reference: install ## hold 300 random scenes against plain integrations (some minutes)
	$(BIN)/python tests/reference/random_scenes.py

bench: install ## time the automaton against what would be used instead (under 3 minutes)
	@$(BIN)/python -c 'import fipy, landlab, taichi' >/dev/null 2>&1 \
		|| $(PIP) --require-hashes -r requirements-bench.lock \
		|| echo 'FiPy, landlab and Taichi cannot be installed here: their benchmarks are skipped' >&2
	$(BIN)/python -m pytest -o addopts='--import-mode=importlib -q --strict-markers' -o python_files='bench_*.py' -o python_functions='bench_*' tests/benchmarks

check: install ## judge all claims again; fails where a verdict differs from reports/verdicts.csv
	$(BIN)/bcre check

lint: install ## ruff and mypy
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

clean: ## remove the environment, caches and everything that is built
	rm -rf .venv .cache .mypy_cache .pytest_cache .ruff_cache .hypothesis docs/_build out reports/local
	find ca pde studies tests -name __pycache__ -type d -prune -exec rm -rf {} +
