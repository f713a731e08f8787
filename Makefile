# Two commands to remember: `make demo` and `make test`. Both set everything up first.

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
SCENE  ?= sorting/4t-07
SECONDS ?= 600
SEED   ?= 0

.PHONY: demo test lint check slow fuzz lock clean help vscode

help:
	@echo "make demo   plan a sorting scene, certify the plan, write a page to watch it (SCENE=...)"
	@echo "make test   all fast tests"
	@echo "make slow   end-to-end tests that take minutes"
	@echo "make fuzz   damaged files of every format, for ten minutes (SECONDS=..., SEED=...)"
	@echo "make lint   lint and types"
	@echo "make check  lint, types and fast tests, for the daily loop"
	@echo "make vscode package the VS Code extension (needs Node.js)"
	@echo "make lock   resolve the dependencies anew"

$(READY): requirements.lock pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	@touch $@

demo: $(READY)
	@mkdir -p out
	$(BIN)/sketchlang run pick_and_place $(SCENE) --out out/plan.json
	$(BIN)/sketchlang validate out/plan.json
	$(BIN)/sketchlang replay out/plan.json --html out/replay.html
	@echo "to watch it, open out/replay.html in a browser"

test: $(READY)
	$(BIN)/python -m pytest

slow: $(READY)
	$(BIN)/python -m pytest -m slow

fuzz: $(READY)
	$(BIN)/python -m tests.fuzz --seconds $(SECONDS) --seed $(SEED)

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

check: lint test

vscode:
	cd editors/vscode && npm ci --no-progress && npm run -s package
	@echo "to install it: code --install-extension editors/vscode/dist/sketchlang.vsix"

lock:
	$(BIN)/python -m pip install --quiet "pip-tools>=7.5"
	$(BIN)/pip-compile --quiet --generate-hashes --strip-extras --allow-unsafe --extra dev \
	  --no-emit-index-url --no-emit-find-links --no-emit-trusted-host --no-header \
	  --output-file requirements.lock pyproject.toml

clean:
	rm -rf $(VENV) plan.json
