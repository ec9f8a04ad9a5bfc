# Isotorque: `make demo` and `make test` are all a fresh machine needs (Python 3.11+ and make).
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
EXTRAS ?= test
OUT ?= out/2r
OLDEST ?= .venv-oldest

# Wide and quick: every package that is imported does some work in one of these.
OLDEST_TESTS := \
  tests/house tests/symbolic/gravity tests/symbolic/polynomials tests/symbolic/lattices \
  tests/symbolic/level_sets tests/symbolic/robots tests/learning/export tests/learning/files \
  tests/learning/learners/local_linear tests/learning/learners/memory tests/learning/simulator/compiled \
  tests/verify/report tests/isotorque/test_parallel.py tests/isotorque/cli/every_command/test_command_line.py \
  tests/isotorque/cli/test_help_text.py tests/isotorque/cli/test_robot_options.py \
  tests/isotorque/cli/every_command/test_start.py isotorque/symbolic/common isotorque/symbolic/groups

.PHONY: help demo test test-slow test-oldest dist lint bench docs clean
.DEFAULT_GOAL := help

help: ## list the targets
	@grep -hE '^[a-z-]+:.*##' $(MAKEFILE_LIST) | sed -E 's/^([a-z-]+):.*## /\1|/' | column -t -s '|'

$(BIN)/python:
	$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed")'
	$(PYTHON) -m venv $(VENV)

# one stamp per set of extras: what is installed already is not asked for again
$(VENV)/.installed-%: $(BIN)/python pyproject.toml constraints.txt
	$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[$*]'
	@touch $@

demo: $(VENV)/.installed-$(EXTRAS) ## derive, discover, learn and judge the 2R arm; prints where the report is
	$(BIN)/isotorque run 2r --out $(OUT)

test: $(VENV)/.installed-$(EXTRAS) ## run the tests (under 8 minutes on 2 cores)
	$(BIN)/python -m pytest -n 2 --dist loadfile

test-slow: $(VENV)/.installed-test,robots,bench,cluster ## run the slow tests too
	$(BIN)/python -m pytest -n 2 --dist worksteal --slow -m slow --durations 10

$(OLDEST)/.installed: pyproject.toml oldest-constraints.txt
	$(PYTHON) -m venv --clear $(OLDEST)
	$(OLDEST)/bin/python -m pip install --quiet --disable-pip-version-check -c oldest-constraints.txt -e '.[test]'
	@touch $@

# old packages beside new ones warn of each other: that is nobody's fault here
test-oldest: $(OLDEST)/.installed ## run a share of the tests with the lowest versions declared
	NUMBA_CACHE_DIR=$(abspath $(OLDEST))/numba $(OLDEST)/bin/python -m pytest -n 2 --dist worksteal \
	  -W ignore::DeprecationWarning $(OLDEST_TESTS)

dist: $(VENV)/.installed-test ## build sdist and wheel of the last commit, from a clean export
	rm -rf dist && mkdir dist
	export=$$(mktemp -d) && git archive HEAD | tar -x -C $$export && cd $$export && \
	  $(abspath $(BIN))/python -c "from setuptools import build_meta as b; b.build_sdist('$(CURDIR)/dist')"
	$(BIN)/python -m pip wheel --quiet --no-deps --no-build-isolation -w dist dist/*.tar.gz

lint: $(VENV)/.installed-test,lint ## style, types and import contracts
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy
	$(BIN)/lint-imports

bench: $(VENV)/.installed-test,robots,bench ## measure costs as ratios, side by side; about ten minutes
	$(BIN)/python -m benchmarks

docs: $(VENV)/.installed-test,robots,bench ## make the figures and tables of docs/ anew
	$(BIN)/python -m docs.make

clean: ## remove the environment and all results
	rm -rf $(VENV) $(OLDEST) out build dist *.egg-info
