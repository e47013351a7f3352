# MART's verbs. Each works from a fresh clone on Debian 12 or 13 with Python 3 and make; `make` lists them.
SHELL := /bin/bash
.SHELLFLAGS := -eu -o pipefail -c
.DEFAULT_GOAL := help
.DELETE_ON_ERROR:
MAKEFLAGS += --no-print-directory --no-builtin-rules
# Where it is set, each of the hundreds of processes that the tests start compiles its modules anew: a fifth of their time.
unexport PYTHONDONTWRITEBYTECODE

PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
PIP := $(BIN)/pip --disable-pip-version-check -qq
NODE := node_modules
NODE_BIN := $(NODE)/.bin

# Every part is a distribution of its own; this is the one list of them.
DISTRIBUTIONS := protocol libraries/runtime libraries/episodes libraries/render libraries/rollouts libraries/operators libraries/lerobot services/sim services/teleop-gateway services/recorder services/driver services/trainer services/web platform
PARTS := $(patsubst %/pyproject.toml,%,$(wildcard $(addsuffix /pyproject.toml,$(DISTRIBUTIONS))))
PART_SOURCES := $(addsuffix /pyproject.toml,$(PARTS)) $(wildcard services/sim/setup.py services/sim/src/mart/sim/world/*.c)

PROTO_DIR := protocol/proto
PROTOS := $(wildcard $(PROTO_DIR)/mart/v1/*.proto)
PROTOC = $(BIN)/python -m grpc_tools.protoc --proto_path=$(PROTO_DIR) --python_out=$(1) --pyi_out=$(1) $(PROTOS)

# What the pages use of three.js, as one module: made from its package, not in the repository.
PAGE_LIBRARIES := services/web/src/mart/web/static/vendor/three.mjs

# LeRobot needs other versions than the parts, so it is installed beside them (docs/decisions/0075).
LEROBOT := .venv-lerobot
ROBOMIMIC := .venv-robomimic
LEROBOT_PARTS := protocol libraries/runtime libraries/episodes libraries/operators libraries/render libraries/rollouts libraries/lerobot services/driver services/trainer

BENCHMARKS := $(subst _,-,$(filter-out report,$(basename $(notdir $(wildcard benchmarks/*.py)))))

# Unit tests share nothing but the machine, so they run on every core. Tests of processes mostly wait: two at a time, each
# file's by the same worker, because they share the processes, and files of long tests first (tests/conftest.py). Browsers
# have the machine for themselves.
PYTEST_UNITS = $(BIN)/pytest --numprocesses auto --maxprocesses 8 --dist worksteal
PYTEST_SYSTEM = $(BIN)/pytest --numprocesses 2 --dist loadfile --no-loadscope-reorder

TASK ?=
COMPOSE = $(shell docker compose version >/dev/null 2>&1 && echo docker compose || echo docker-compose)

##@ Use

.PHONY: run
run: $(VENV)/.parts ## Run the whole platform with one room and print the lobby's address; TASK=… chooses the task
	@$(BIN)/mart run $(if $(TASK),--task $(TASK))

.PHONY: demo
demo: $(VENV)/.tools ## Record three episodes with emulated phones and real browsers, one JSON line each
	@$(BIN)/mart demo

.PHONY: up
up: ## Run the platform as containers and print the lobby's address and the join code
	@tools/compose-up $(COMPOSE)

.PHONY: down
down: ## Stop the containers; episodes, secrets and certificates stay in their volumes
	@$(COMPOSE) down

##@ Work on it

.PHONY: setup
setup: $(VENV)/.tools ## Make .venv with every part and tool, and install missing system packages

.PHONY: test
test: $(VENV)/.tools ## Run every test but the repository's own rules and those that need a container engine
	@$(PYTEST_UNITS) -m unit
	@$(PYTEST_SYSTEM) -m system
	@$(BIN)/pytest tests/browser

.PHONY: test-fast
test-fast: $(VENV)/.tools ## Run the quick unit tests: at most 90 s on two cores
	@$(PYTEST_UNITS) -m "unit and not slow"

.PHONY: test-compose
test-compose: $(VENV)/.tools ## Build the images and collect an episode through the containers; needs an engine
	@$(BIN)/pytest tests/compose

.PHONY: test-lerobot
test-lerobot: $(VENV)/.tools $(LEROBOT)/.installed ## Try LeRobot's robots, commands and data sets against a room, in an environment of their own: 2 GB
	@LEROBOT_ENVIRONMENT=$(LEROBOT) $(BIN)/pytest tests/lerobot

.PHONY: test-robomimic
test-robomimic: $(VENV)/.tools $(ROBOMIMIC)/.installed ## Have robomimic open and learn from an export, in an environment of its own: 1.5 GB
	@ROBOMIMIC_ENVIRONMENT=$(ROBOMIMIC) $(BIN)/pytest tests/robomimic

.PHONY: check
check: $(VENV)/.tools check-proto check-pages docs ## Check style, types, import rules, generated code, the documentation and the repository's own rules
	@$(BIN)/ruff check
	@$(BIN)/ruff format --check
	@$(BIN)/mypy
	@$(BIN)/lint-imports --no-logo
	@$(BIN)/pytest --quiet tests/contract

.PHONY: format
format: $(VENV)/.tools ## Format the code and mend what the linter can mend
	@$(BIN)/ruff check --fix-only --quiet
	@$(BIN)/ruff format

.PHONY: bench
bench: $(addprefix bench-,$(BENCHMARKS)) ## Run every benchmark; results go to benchmarks/results

bench-%: $(VENV)/.tools ## Run one benchmark, for example bench-barrier
	@PYTHONPATH=. $(BIN)/python benchmarks/$(subst -,_,$*).py

.PHONY: chaos
chaos: $(VENV)/.tools ## Try every fault once and write the table of docs/reliability.md: about half an hour on a quiet machine
	@$(BIN)/python -m tools.chaos

.PHONY: docs
docs: $(VENV)/.tools ## Build the documentation site into build/site; every warning is an error
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

.PHONY: dist
dist: $(VENV)/.build ## Build a wheel of every part into dist, and see that each holds what its part does
	@rm -rf dist $(addsuffix /build,$(PARTS))
	@$(PIP) wheel --constraint constraints.txt --no-build-isolation --no-deps --wheel-dir dist $(addprefix ./,$(PARTS))
	@rm -rf $(addsuffix /build,$(PARTS))
	@$(BIN)/python tools/check_wheels.py dist

.PHONY: try-dist
try-dist: dist ## Install the wheels into a clean environment and use them there as a stranger would
	@tools/try-wheels dist

.PHONY: proto
proto: $(VENV)/.tools ## Generate the Python code of the protobuf schemas
	@$(call PROTOC,protocol/src)

.PHONY: check-proto
check-proto: $(VENV)/.tools
	@fresh=$$(mktemp -d); trap 'rm -rf "$$fresh"' EXIT; $(call PROTOC,"$$fresh"); \
	diff -r --brief --exclude=__pycache__ "$$fresh/mart/v1" protocol/src/mart/v1 \
	|| { echo "The generated protobuf code is stale: run 'make proto' and commit the result." >&2; exit 1; }

.PHONY: check-pages
check-pages: $(NODE)/.installed
	@$(NODE_BIN)/eslint --max-warnings 0 .
	@$(NODE_BIN)/tsc

.PHONY: task-pages
task-pages: $(VENV)/.tools ## Write docs/tasks.md and draw its pictures anew, from the catalogue and the scenes
	@$(BIN)/python tools/task_pages.py

.PHONY: page-facts
page-facts: $(VENV)/.tools ## Write what the pages know from the Python parts: lists, limits, colours, types
	@$(BIN)/python tools/page_facts.py

.PHONY: operator-picture
operator-picture: $(VENV)/.tools ## Take the picture of the operator's page anew, in a real browser
	@$(BIN)/python tools/operator_picture.py

.PHONY: session-picture
session-picture: $(VENV)/.tools ## Take the README's moving picture anew: one episode, in a real browser
	@$(BIN)/python tools/session_picture.py

.PHONY: constraints
constraints: ## Pin the newest versions of everything anew, from a real installation
	@tools/pin $(PYTHON) $(PARTS)

.PHONY: clean
clean: ## Remove everything that was built or recorded by tests; recorded episodes stay
	@rm -rf $(VENV) $(LEROBOT) $(NODE) $(PAGE_LIBRARIES) build dist test-output .mypy_cache .ruff_cache .pytest_cache .import_linter_cache .hypothesis
	@find protocol libraries services platform -name '*.egg-info' -prune -exec rm -rf {} + -o -name '*.so' -delete

.PHONY: help
help: ## List the verbs
	@awk -F ':.*## ' '/^##@/ { printf "\n%s\n", substr($$0, 5) } /^[a-z%-]+:.*## / { sub("%", "NAME", $$1); printf "  make %-16s %s\n", $$1, $$2 }' Makefile

# What the verbs above stand on. A stamp is newer than all that it was made from, or it is made again.

$(VENV)/bin/python:
	@tools/system-packages build
	@echo "Installing into $(VENV) …" >&2
	@$(PYTHON) -m venv $(VENV)

# mujoco-core carries the headers that the sim's C code is compiled against, so it comes before the parts.
$(VENV)/.build: $(VENV)/bin/python constraints.txt
	@$(PIP) install --constraint constraints.txt pip setuptools wheel mujoco-core
	@touch $@

$(VENV)/.parts: $(VENV)/.build $(PART_SOURCES) $(PAGE_LIBRARIES)
	@tools/system-packages render
	@tools/cpu-torch $(BIN)/python constraints.txt
	@$(PIP) install --constraint constraints.txt --no-build-isolation $(addprefix --editable ,$(PARTS))
	@touch $@

$(VENV)/.tools: $(VENV)/.parts pyproject.toml
	@tools/system-packages browser
	@$(PIP) install --constraint constraints.txt --group dev
	@touch $@

$(LEROBOT)/.installed: tools/lerobot-environment constraints.txt $(addsuffix /pyproject.toml,$(LEROBOT_PARTS))
	@PYTHON=$(PYTHON) tools/lerobot-environment $(LEROBOT) $(LEROBOT_PARTS)
	@touch $@

$(ROBOMIMIC)/.installed: tools/robomimic-environment $(wildcard benchmarks/peers/robomimic/requirements*.txt)
	@PYTHON=$(PYTHON) tools/robomimic-environment $(ROBOMIMIC)
	@touch $@

# Nothing of these packages is run but esbuild, eslint and tsc, and none of their install scripts.
$(NODE)/.installed: package.json package-lock.json .npmrc
	@tools/system-packages pages
	@npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >/dev/null
	@touch $@

$(PAGE_LIBRARIES): $(NODE)/.installed services/web/vendor/three.js tools/page-libraries
	@tools/page-libraries
