# `make test` is what CI runs. Everything it needs comes from crates.io and PyPI.
.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
BIN := $(CURDIR)/$(VENV)/bin

.PHONY: help test fmt-check lint test-rust test-doc python test-python validate bench demo clean

help: ## Show the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  %-12s %s\n", $$1, $$2}'

test: fmt-check lint test-rust test-doc test-python ## Run all checks: what CI runs

fmt-check: ## Formatting
	cargo fmt --all -- --check

lint: ## Lints, warnings are errors
	cargo clippy --workspace --all-targets -- -D warnings

test-rust: ## Rust tests
	cargo test --workspace --lib --bins --tests

test-doc: ## Rust documentation builds without warnings, its examples run
	cargo test --workspace --doc
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

$(VENV)/.installed: crates/py/pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --upgrade pip
	$(BIN)/python -m pip install --quiet "maturin>=1.9,<2" numpy pytest mypy pandas xarray mcap
	touch $@

python: $(VENV)/.installed ## Build the Python package into a private environment
	cd crates/py && VIRTUAL_ENV=$(CURDIR)/$(VENV) $(BIN)/maturin develop --quiet

test-python: python ## Python tests, stub check and examples
	$(BIN)/python -m pytest -q crates/py/tests
	$(BIN)/python -m mypy.stubtest anergy
	$(BIN)/python examples/three-houses/run.py

validate: ## Slow cases, peers, large random sets
	PROPTEST_CASES=2000 cargo test --release -p anergy-tests --test every_element --test random_networks

bench: ## Criterion benches
	cargo bench -p anergy-benches

demo: ## The main job on the embedded study
	cargo run --release -- demo

clean: ## Remove what was built
	cargo clean
	rm -rf $(VENV) results
