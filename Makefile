# Each of these does all the set-up that its job needs; the stamps make the next run start at once.
PYTHON ?= python3
STUDIO = .venv/bin/python main.py

.PHONY: run test bench examples format

run: .venv/.ready-to-run
	@$(STUDIO)

test: .venv/.ready-to-test
	.venv/bin/ruff format --check .
	.venv/bin/ruff check .
	.venv/bin/mypy
	.venv/bin/lint-imports --no-logo
	.venv/bin/python -m pytest

bench: .venv/.ready-to-run
	@$(STUDIO) bench

examples: .venv/.ready-to-run
	@set -e; for script in examples/make_*.py; do echo "$$script"; .venv/bin/python "$$script"; done

format: .venv/.ready-to-test
	.venv/bin/ruff format .
	.venv/bin/ruff check --fix .

.venv/.ready-to-%: pyproject.toml constraints.txt .ci/set-up
	@PYTHON="$(PYTHON)" .ci/set-up $*
