# Each of these does all the set-up that its job needs; the stamps make the next run start at once.
SHELL = /bin/bash
.SHELLFLAGS = -o pipefail -ec
PYTHON ?= python3
STUDIO = .venv/bin/python main.py

# The tests for `make check`, about a minute with lint and types beside them; `make test` runs every one.
FAST = tests/architecture tests/document tests/panels tests/timeline

# `make test` runs the tests in jobs of some minutes, one more at once than there are processors, because tests wait for
# timers and other processes. Those that take longest come first, so that no processor is idle for long in the end.
JOBS = gui files core rest live real
tests_gui = tests/gui
tests_core = tests/core
# With captures of people tests/real takes longer than all others together, hence two jobs.
tests_real = $(wildcard tests/real/test_[a-p]*.py)
tests_live = $(filter-out $(tests_real),$(wildcard tests/real/test_*.py)) tests/live tests/engine tests/monkey
tests_files = tests/io tests/library tests/examples tests/document
tests_rest = $(filter-out tests/real $(foreach job,$(filter-out rest,$(JOBS)),$(tests_$(job))),$(FOLDERS))
# Outside tests/real few tests need captures of people, so that one process that loads the program serves them all.
tests_captures = $(tests_files) $(tests_core) $(tests_rest)
FOLDERS = $(patsubst %/,%,$(sort $(dir $(wildcard tests/*/test_*.py))))
AT_ONCE = $(shell expr $$(getconf _NPROCESSORS_ONLN) + 1)

# Lines of jobs that run at once are shown as they come, each with the name of its job.
shown = ($(1)) 2>&1 | while IFS= read -r line; do echo "$@: $$line"; done

# More arguments for pytest, for example: make test PYTEST="-m captures". A job of which they leave nothing passes.
PYTEST ?=

.PHONY: run check test kernels $(JOBS) captures lint fast bench quality soak examples pictures films format

run: .venv/.ready-to-run
	@$(STUDIO)

check: .venv/.ready-to-test
	@$(MAKE) --no-print-directory --jobs 2 lint fast

test: .venv/.ready-to-test
	@$(MAKE) --no-print-directory --jobs 2 kernels lint
	@$(MAKE) --no-print-directory --jobs $(AT_ONCE) $(JOBS)

kernels: .venv/.ready-to-test
	@$(call shown,.venv/bin/python -m tests.compile_kernels)

$(JOBS) captures: .venv/.ready-to-test
	@$(call shown,.venv/bin/python -u -m pytest $(PYTEST) $(tests_$@) $(if $(PYTEST),|| [ $$? = 5 ]))

lint: .venv/.ready-to-test
	@$(call shown,.venv/bin/ruff format --check . && .venv/bin/ruff check . && .venv/bin/mypy)
	@$(call shown,.venv/bin/lint-imports --no-logo)

fast: .venv/.ready-to-test
	@$(call shown,.venv/bin/python -u -m pytest -q $(FAST) --ignore tests/architecture/test_wheel.py)

bench: .venv/.ready-to-run
	.venv/bin/python -m benchmarks.bench
	.venv/bin/python benchmarks/long_capture.py
	.venv/bin/python -m benchmarks.retrieval
	.venv/bin/python -m benchmarks.window

quality: .venv/.ready-to-run
	.venv/bin/python benchmarks/quality_tables.py $(FOLDER) $(if $(CHARACTERS),--characters $(CHARACTERS))

soak: .venv/.ready-to-test
	.venv/bin/python -m tests.soak
	.venv/bin/python -m pytest -q -m hypothesis --hypothesis-profile=deep

examples: .venv/.ready-to-run
	@set -e; for made in captures strikes characters sample; do echo "$$made"; .venv/bin/python examples/make_$$made.py; done

pictures: .venv/.ready-to-test
	.venv/bin/python examples/make_pictures.py

# Sheets and films of captures on bodies beside their source, to be looked at: make films FOLDER=films.
films: .venv/.ready-to-run
	.venv/bin/python examples/make_films.py $(or $(FOLDER),films)

format: .venv/.ready-to-test
	.venv/bin/ruff format .
	.venv/bin/ruff check --fix .

.venv/.ready-to-%: pyproject.toml constraints.txt .ci/set-up
	@PYTHON="$(PYTHON)" .ci/set-up $*
