# Two commands matter: `make demo` and `make test`. Both set up what they need in .venv.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
OUT ?= out/demo
WORKERS ?= auto
# A seed of the day, printed; a failure is repeated with the one that was.
SEED ?= $(shell date +%Y%m%d)
MUTANTS_SEED ?= 1
COUNT ?= 150
MINUTES ?= 480
# Without bytecode each process compiles a thousand modules anew, and pytest its tests.
unexport PYTHONDONTWRITEBYTECODE

.PHONY: accuracy help demo lab test slow gate costs figures check lint types layers gallery pictures docs bench coverage nightly campaign release clean

help:  ## show this list
	@grep -E '^[a-z]+:.*##' $(MAKEFILE_LIST) | sed -E 's/:.*## /\t/' | expand -t 12

# A fresh virtual environment has pip; the constraints pin everything else.
$(VENV)/run.stamp: pyproject.toml constraints.txt
	@echo "Setting up $(VENV) (once; takes a minute or two)"
	@test -x $(BIN)/python || $(PYTHON) -m venv $(VENV)
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e .
	@touch $@

$(VENV)/all.stamp: $(VENV)/run.stamp
	@echo "Adding what lab, bench, design and studies need to $(VENV)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[all]'
	@touch $@

$(VENV)/test.stamp: $(VENV)/run.stamp
	@echo "Adding what tests and docs need to $(VENV)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check -c constraints.txt -e '.[test,firmware-test,oracles,docs]'
	@touch $@

demo: $(VENV)/run.stamp  ## analyse the paper's plate and write a report
	@$(BIN)/squeezefilm analyze biet2008-plate --out $(OUT)

lab: $(VENV)/all.stamp  ## open the lab in the browser
	@$(BIN)/squeezefilm lab

# Twins and loops in real time are tested last and alone: a device stops when its host is held up
# for 50 ms, as it must, and other tests would hold it up. Both runs happen even if the first fails.
PYTEST := $(BIN)/python -m pytest
# A second argument names a mark: only files that have it are read, which takes a second in place of ten.
# Files of tests, all unless said: `TESTS="tests/unit/physics/film"`, or those of a room or folder: `PART=film`.
PART ?=
TESTS ?= $(if $(PART),$(or $(shell $(BIN)/python tools/part_tests.py $(PART)),$(error no tests of PART=$(PART))),tests)
define run_tests
@failed=0; tests="$(TESTS)"; \
$(if $(2),tests=$$(grep -rl --include='test_*.py' 'mark\.$(2)' $$tests); test -n "$$tests" || exit 0;) \
$(PYTEST) -n $(WORKERS) -m "not campaign and not realtime $(1)" $$tests || failed=1; \
realtime=$$(grep -rl --include='test_*.py' 'pytest.mark.realtime' $$tests); \
test -z "$$realtime" || $(PYTEST) -m "not campaign and realtime $(1)" $$realtime; \
code=$$?; test $$code = 0 -o $$code = 5 || failed=1; \
exit $$failed
endef

QUICK := and not slow and not nightly

test: $(VENV)/test.stamp  ## run the quick tests, in some five minutes; of a room or folder: PART=film
	$(call run_tests,$(QUICK))

slow: export PYTEST_ADDOPTS += --durations=40
slow: $(VENV)/test.stamp  ## run the tests that take seconds each, as CI does after the quick ones
	$(call run_tests,and slow and not nightly,slow)

gate: $(VENV)/test.stamp  ## reliability: crash, kill, disk, fuzz, token, watchdog …, with a table
	@$(BIN)/python tools/gate.py

# Solved anew, so that every line is seen that a test needs; which test ran it is kept for mutants.
coverage: export SQUEEZEFILM_CACHE = off
coverage: $(VENV)/test.stamp  ## branches that the quick tests take
	@failed=0; \
	$(PYTEST) -n $(WORKERS) -m "not campaign and not realtime $(QUICK)" --cov --cov-context=test --cov-report= \
	  || failed=1; \
	$(BIN)/coverage report --skip-covered --sort=-cover; \
	exit $$failed

costs: $(VENV)/test.stamp  ## processor time of the tests by folder and file, into the documentation
	@$(PYTEST) -n $(WORKERS) -p tests.costs --costs docs/development/test-costs.md \
	  -m "not campaign and not realtime and not nightly"

# What neither `make test` nor `make slow` runs, and the properties again, with other examples.
nightly: export SQUEEZEFILM_EXPLORE = 1
nightly: export PYTEST_ADDOPTS += --hypothesis-seed=$(SEED) --durations=25
nightly: $(VENV)/test.stamp  ## run what takes minutes or is repeated by the hundred, and explore properties (SEED=N)
	@echo "nightly: seed $(SEED)"
	$(call run_tests,and (nightly or hypothesis))

campaign: $(VENV)/test.stamp  ## what takes hours and goes on where it stopped: statistics, mutants
	@nice $(PYTEST) -n $(WORKERS) -p tests.campaign --answers campaigns/statistics.jsonl -m campaign
	@nice $(BIN)/python tools/mutants.py --nightly --seed $(MUTANTS_SEED) --count $(COUNT) \
	  --minutes $(MINUTES) --file campaigns/mutants-$(MUTANTS_SEED).jsonl

# The figures that quick tests draw, in words and numbers beside the tests; read the diff before it is committed.
figures: export SQUEEZEFILM_DESCRIBE = anew
figures: $(VENV)/test.stamp  ## describe the figures of the tests anew
	@tests=$$(grep -rl --include='test_*.py' 'figures_as_described' tests/unit); \
	rm -f $$(echo $$tests | sed 's/\.py/.txt/g'); \
	$(PYTEST) -n 0 -m "not campaign and not realtime $(QUICK)" $$tests

check: lint types layers docs  ## everything that is read and not run

lint: $(VENV)/test.stamp  ## style
	@$(BIN)/ruff check .
	@$(BIN)/ruff format --check .

types: $(VENV)/test.stamp  ## mypy, strict
	@$(BIN)/mypy

layers: $(VENV)/test.stamp  ## who may import whom
	@$(BIN)/lint-imports

gallery: $(VENV)/run.stamp  ## draw the preset textures for the documentation
	@$(BIN)/python tools/gallery.py

pictures: $(VENV)/test.stamp  ## draw the pictures of the README, with a Chromium
	@$(BIN)/python tools/pictures.py

accuracy: $(VENV)/test.stamp  ## measure how far the numbers are off, into the documentation
	@$(BIN)/python tools/accuracy.py

docs: $(VENV)/test.stamp  ## build the documentation, strictly, with examples run and drawn: some two minutes
	@rm -rf docs/examples
	@NO_MKDOCS_2_WARNING=1 $(BIN)/mkdocs build --strict --quiet

bench: $(VENV)/test.stamp  ## measure speed against peers, as ratios
	@for file in benchmarks/*.py; do $(BIN)/python $$file || exit 1; done

release: $(VENV)/test.stamp  ## sdist and wheel into dist/, checked, tried in a clean environment
	@$(BIN)/python tools/release.py dist

clean:  ## remove what was built
	rm -rf $(VENV) dist build site out .mypy_cache .ruff_cache .pytest_cache .import_linter_cache
