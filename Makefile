# Isotorque: `make demo` and `make test` are all a fresh machine needs (Python 3.11+ and make).
PYTHON ?= python3
VENV ?= .venv
BIN := $(VENV)/bin
EXTRAS ?= test
OUT ?= out/2r

.PHONY: help demo test test-slow lint bench docs clean
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
	rm -rf $(VENV) out build *.egg-info
