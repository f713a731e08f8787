# Two commands to remember: `make demo` and `make test`. Both set everything up first.

PYTHON ?= $(shell command -v python3.11 || command -v python3)
VENV   := .venv
BIN    := $(VENV)/bin
READY  := $(VENV)/.ready
SCENE  ?= sorting/4t-07
SECONDS ?= 600
SEED   ?= 0

# Tests run in a process a core, four at most: each of them holds compiled kernels.
PYTEST := $(BIN)/python -m pytest --numprocesses auto --maxprocesses 4 --dist worksteal

# One or two files of each room, of those that answer at once.
QUICK  := tests/test_architecture.py tests/spec tests/language/test_cli.py \
          tests/language/test_domain.py tests/analysis/test_known.py \
          tests/analysis/test_elimination.py tests/analysis/test_coverage.py \
          tests/pddl/test_semantics.py tests/pddl/test_run.py tests/tabletop/test_state.py \
          tests/tabletop/test_items.py tests/tabletop/test_words.py \
          tests/tabletop/scene/test_load.py tests/runtime/search tests/runtime/robot/test_load.py \
          tests/runtime/world/test_tops.py tests/runtime/judge/test_replay.py \
          tests/runtime/plan/test_version_1.py tests/trust/test_reading.py

.PHONY: demo quick test lint check slow fuzz lock clean help vscode site kinder

help:
	@echo "make demo   plan a sorting scene, certify the plan, write a page to watch it (SCENE=...)"
	@echo "make quick  the first answer: ruff and a few tests of each room, in seconds"
	@echo "make test   all fast tests"
	@echo "make slow   end-to-end tests that take minutes"
	@echo "make fuzz   damaged files of every format, for ten minutes (SECONDS=..., SEED=...)"
	@echo "make lint   lint and types"
	@echo "make check  lint, types and fast tests, for the daily loop"
	@echo "make vscode package the VS Code extension (needs Node.js)"
	@echo "make site   the documentation as a site, with a playground, in out/site (needs Node.js)"
	@echo "make kinder the environments of KinDER, beside ours (1.9 GB): sketchlang bench kinder"
	@echo "make lock   resolve the dependencies anew"

$(READY): requirements.lock pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements.lock
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-deps --no-build-isolation --editable .
	$(BIN)/python -m compileall -q sketchlang runtime domains grammars
	@touch $@

demo: $(READY)
	@mkdir -p out
	$(BIN)/sketchlang run pick_and_place $(SCENE) --improve 2 --out out/plan.json
	$(BIN)/sketchlang validate out/plan.json
	$(BIN)/sketchlang replay out/plan.json --html out/replay.html
	@echo "to watch it, open out/replay.html in a browser"

quick: $(READY)
	$(BIN)/ruff check --quiet .
	$(PYTEST) $(QUICK)

test: $(READY)
	$(PYTEST)

slow: $(READY)
	$(PYTEST) -m slow

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

# The generator of the site has an environment of its own: its packages meet nobody else's.
SITE := $(VENV)/site

$(SITE)/.ready: $(READY) docs/site/requirements.lock docs/site/package-lock.json
	$(PYTHON) -m venv $(SITE)
	$(SITE)/bin/python -m pip install --quiet --disable-pip-version-check --require-hashes -r docs/site/requirements.lock
	npm ci --prefix docs/site --silent --no-audit --no-fund
	@touch $@

site: $(SITE)/.ready
	$(BIN)/python -m docs.site.build --zensical $(SITE)/bin/zensical

# The environments of KinDER need an older numpy: they have an environment of their own as well.
KINDER := $(VENV)/kinder

$(KINDER)/.ready: $(READY)
	$(PYTHON) -m venv $(KINDER)
	$(KINDER)/bin/python -m pip install --quiet --disable-pip-version-check kindergarden==0.2.5
	$(BIN)/sketchlang bench kinder --envs Table3D-o1 --seeds 0
	@touch $@

kinder: $(KINDER)/.ready

lock:
	$(BIN)/python -m pip install --quiet "pip-tools>=7.5"
	$(BIN)/pip-compile --quiet --generate-hashes --strip-extras --allow-unsafe --extra dev \
	  --no-emit-index-url --no-emit-find-links --no-emit-trusted-host --no-header \
	  --output-file requirements.lock pyproject.toml

clean:
	rm -rf $(VENV) plan.json
