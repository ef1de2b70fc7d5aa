# One word each: make demo | test | lint | bench | docs. The first one sets up .venv by itself.
# Works with GNU make on Linux and macOS, and on Windows from Git Bash with `choco install make`; there, without make,
# run the lines of a target by hand with .venv\Scripts in place of .venv/bin.
.DEFAULT_GOAL := help
.PHONY: help setup demo test test-long lint style types imports bench golden pictures docs clean
MAKEFLAGS += --no-print-directory

VENV := .venv
BIN := $(VENV)/$(if $(filter Windows_NT,$(OS)),Scripts,bin)
READY := $(VENV)/.ready
# The versions to install: constraints.txt (what the check ran with), constraints-lowest.txt, or empty for the latest.
CONSTRAINTS ?= constraints.txt
PIP := $(BIN)/python -m pip install --quiet --disable-pip-version-check --retries 10 --timeout 60
PYTHON ?= $(shell for p in python3.11 python3.12 python3.13 python3 python; do \
	if $$p -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null; then echo $$p; break; fi; done)

# Real records: SEATRIAL_DATA, or ../shared/data beside the checkout where that exists.
ifeq ($(origin SEATRIAL_DATA),undefined)
ifneq ($(wildcard $(CURDIR)/../shared/data/.),)
export SEATRIAL_DATA := $(abspath $(CURDIR)/../shared/data)
endif
endif

# As the command line: threads of the linear algebra would wait for one another.
export OPENBLAS_NUM_THREADS ?= 1

help:
	@echo 'make demo   run the main job on a simulated trial series; the report lies in demo/'
	@echo 'make test   the test suite, with a sample of the long tests (make test-long)'
	@echo 'make lint   style, types and the order of the layers (make style, make types, make imports)'
	@echo 'make bench  times and ratios on this machine'
	@echo 'make golden compare results with the recorded ones, trial by trial'
	@echo 'make docs   build the documentation into site/'

setup: $(READY)

$(READY): pyproject.toml $(CONSTRAINTS)
	@test -n "$(PYTHON)" || { echo 'seatrial needs Python 3.11 or newer; name it with make PYTHON=/path/to/python3'; exit 1; }
	@echo 'setting up $(VENV) ...'
	@$(BIN)/python -c '' 2>/dev/null || $(PYTHON) -m venv $(VENV) || \
		{ rm -rf $(VENV); echo 'this Python cannot make virtual environments; on Debian: apt-get install python3-venv'; exit 1; }
	@for attempt in 1 2 3; do \
		$(PIP) $(addprefix -c ,$(CONSTRAINTS)) -e '.[app,formats,logs,bounds,fmu,cluster,sampling,dev]' && break; \
		if [ $$attempt = 3 ]; then echo 'packages could not be installed; check the network and run make again'; exit 1; fi; \
		echo "attempt $$attempt failed, trying again"; sleep 5; \
	done
	@touch $@

demo: $(READY)
	@$(BIN)/seatrial demo --out demo --json demo/result.json

test: $(READY)
	@$(BIN)/python -m pytest -n 2 --dist loadfile --no-loadscope-reorder

test-long: $(READY)
	@$(BIN)/python -m pytest -n 2 -m long

lint: style types imports

style: $(READY)
	@$(BIN)/ruff check --quiet .
	@$(BIN)/ruff format --check --quiet .

types: $(READY)
	@$(BIN)/basedpyright --pythonpath $(BIN)/python

imports: $(READY)
	@$(BIN)/lint-imports --no-cache

bench: $(READY)
	@$(BIN)/python benchmarks/run.py

golden: $(READY)
	@$(BIN)/python benchmarks/golden.py

pictures: $(READY)
	@$(BIN)/python docs/make_pictures.py

docs: pictures
	@$(BIN)/python -m sphinx -W --keep-going -q docs site
	@$(BIN)/python docs/contact_sheet.py site
	@echo 'the documentation lies in site/index.html'

clean:
	@rm -rf $(VENV) site jupyter_execute demo build dist .pytest_cache .ruff_cache .hypothesis
