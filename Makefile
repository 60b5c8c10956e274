# `make test` is what CI runs. Everything it needs comes from crates.io and PyPI.
.DEFAULT_GOAL := help
PYTHON ?= python3
VENV := .venv
BIN := $(CURDIR)/$(VENV)/bin

.PHONY: help test fmt-check lint test-rust test-doc python test-python test-wheel docs validate peers explain-score explain-advice explain-stories bench bench-thermal bench-memory bench-peers bench-ensemble learn instructions demo clean

help: ## Show the targets
	@grep -hE '^[a-z-]+:.*## ' $(MAKEFILE_LIST) | awk -F ':.*## ' '{printf "  %-13s %s\n", $$1, $$2}'

test: fmt-check lint test-rust test-doc test-python test-wheel ## Run all checks: what CI runs

fmt-check: ## Formatting
	cargo fmt --all -- --check

lint: ## Lints, warnings are errors
	cargo clippy --workspace --all-targets -- -D warnings

test-rust: ## Rust tests
	cargo test --workspace --lib --bins --tests

test-doc: ## Rust documentation builds without warnings, its examples run
	cargo test --workspace --doc
	RUSTDOCFLAGS="-D warnings" cargo doc --workspace --no-deps --quiet

$(VENV)/.installed: Makefile crates/py/pyproject.toml
	$(PYTHON) -m venv $(VENV)
	$(BIN)/python -m pip install --quiet --disable-pip-version-check "maturin>=1.9.4,<2" numpy \
		"pytest>=8" "mypy>=1.16" pandas pandas-stubs polars pyarrow xarray matplotlib mcap \
		"dask[distributed]" gymnasium SALib
	touch $@

python: $(VENV)/.installed ## Build the Python package into a private environment
	VIRTUAL_ENV=$(CURDIR)/$(VENV) $(BIN)/maturin develop --quiet -m crates/py/Cargo.toml

test-python: python ## Python tests, stub check and examples
	cargo build --workspace --bin anergy
	ANERGY_PROGRAM=$(CURDIR)/target/debug/anergy $(BIN)/python -m pytest -q crates/py tests/hidden_effects
	$(BIN)/python -m mypy.stubtest anergy --mypy-config-file crates/py/pyproject.toml
	$(BIN)/python -m mypy --config-file crates/py/pyproject.toml crates/py/python/anergy crates/py/tests/typed_use.py
	$(BIN)/python examples/three-houses/run.py
	$(BIN)/python examples/town/run.py
	$(BIN)/python examples/cold-plug/run.py
	$(BIN)/python examples/pump-hunting/run.py
	$(BIN)/python examples/grids/run.py
	$(BIN)/python examples/feed-in-types/run.py
	$(BIN)/python examples/5gdhc-street/run.py
	$(BIN)/python examples/two-balancing-units/location.py 6h
	$(BIN)/python examples/soil-study/run.py
	$(BIN)/python examples/rse-facility/run.py
	$(BIN)/python examples/ensembles/sensitivity.py

test-wheel: python ## The wheel in a new environment runs the tutorials as they stand
	rm -rf target/new-user
	$(BIN)/maturin build --quiet -m crates/py/Cargo.toml --out target/new-user
	$(PYTHON) -m venv target/new-user/venv
	target/new-user/venv/bin/python -m pip install --quiet --disable-pip-version-check \
		"$$(ls target/new-user/*.whl)[plot]"
	cd target/new-user && MPLBACKEND=agg venv/bin/python $(CURDIR)/crates/py/new_user.py \
		$(CURDIR)/docs/src/tutorial-python.md $(CURDIR)/docs/src/tutorial-5gdhc.md

docs: ## The documentation as a book, in target/book
	cargo install --quiet --locked --root target/mdbook mdbook@0.4.52
	target/mdbook/bin/mdbook build --dest-dir $(CURDIR)/target/book docs

validate: ## Slow cases, peers, large random sets
	PROPTEST_CASES=2000 NETWORKS=10000 ROBUSTNESS=10000 RSE_TESTS=all WEIGHTED_PI=all HUNTING=500 AMBIENT_DAY=1 LABORATORY=all EXPLAIN=all TABLE_DATE=$$(date +%F) \
		cargo test --release -p anergy-tests --tests -- --nocapture \
		every_element:: random_networks:: robustness:: destest:: openmodelica_heat:: ait_pongau:: ulg_pipe:: pipe_steps:: building:: \
		rse_facility:: weighted_pi:: hunting:: hunting_random:: storage_charging:: ambient_day:: laboratory_houses:: liege:: ait:: rse::
	$(MAKE) explain-stories
	$(MAKE) bench-ensemble

.venv-learn/.installed:
	$(PYTHON) -m venv .venv-learn
	.venv-learn/bin/python -m pip install --quiet --disable-pip-version-check "maturin>=1.9.4,<2" "stable-baselines3>=2.7,<3"
	touch $@

learn: .venv-learn/.installed ## Train agents for anergy.gym and compare them with the rules (large download: torch)
	VIRTUAL_ENV=$(CURDIR)/.venv-learn .venv-learn/bin/maturin develop --release --quiet -m crates/py/Cargo.toml
	OMP_NUM_THREADS=1 .venv-learn/bin/python examples/learning/train.py --steps 200000 Pumps House
	OMP_NUM_THREADS=1 .venv-learn/bin/python examples/learning/train.py --steps 80000 District

.venv-peers/.installed:
	$(PYTHON) -m venv .venv-peers
	.venv-peers/bin/python -m pip install --quiet --disable-pip-version-check \
		wntr==1.5.0 epyt==2.3.5.3 owa-epanet==2.3.5 "pandapipes>=0.16,<0.17" numba
	touch $@

# oemof.thermal wants another numpy than pandapipes.
.venv-heat/.installed:
	$(PYTHON) -m venv .venv-heat
	.venv-heat/bin/python -m pip install --quiet --disable-pip-version-check hplib==1.9 oemof.thermal==0.0.8
	touch $@

peers: .venv-peers/.installed .venv-heat/.installed ## Networks against EPANET and pandapipes, heat pumps and boilers against hplib and oemof, tables into docs
	cargo build --release -p anergy
	.venv-peers/bin/python tests/peers/epanet_import.py --out docs/src/validation/epanet.md
	.venv-peers/bin/python tests/peers/pandapipes_import.py --out docs/src/validation/pandapipes.md
	.venv-heat/bin/python -W ignore tests/peers/heat_generators.py --out docs/src/validation/heat-generators.md

.venv-score/.installed:
	$(PYTHON) -m venv .venv-score
	.venv-score/bin/python -m pip install --quiet --disable-pip-version-check numpy numba pytest
	touch $@

# Seeds below 1 000 000 are of development, from there on for reports. Restartable: what has an answer is not run again.
SEED ?= 1
DRAWS ?= 6
SCORE ?= target/hidden-effects-$(SEED)
RESULTS ?= $(notdir $(lastword $(sort $(wildcard $(SCORE)/results-*))))
explain-score: .venv-score/.installed ## What explain finds in data with a hidden effect: 200 cases, table in docs (SEED, DRAWS)
	cargo build --release -p anergy
	.venv-score/bin/python -m pytest -q tests/hidden_effects
	for rig in R1 R2 R3; do \
		.venv-score/bin/python tests/hidden_effects/twin.py $(SCORE) --rig $$rig && \
		.venv-score/bin/python tests/hidden_effects/cases.py $(SCORE) --rig $$rig --seed $(SEED) --draws $(DRAWS) || exit 1; done
	.venv-score/bin/python tests/hidden_effects/score.py $(SCORE) --out docs/src/validation/explain.md \
		--engine "$$(git rev-parse --short HEAD)"

explain-advice: .venv-score/.installed ## Does what explain recommends tell a class apart? The classes of an explain-score (RESULTS: its folder of answers) with what was recommended
	cargo build --release -p anergy
	.venv-score/bin/python tests/hidden_effects/advice.py $(SCORE) --results $(RESULTS) --out target/explain-advice

explain-stories: .venv-score/.installed ## What experts found in the laboratory, hidden in data: does explain find it? Table in docs
	cargo build --release -p anergy
	.venv-score/bin/python tests/hidden_effects/stories.py target/explain-stories --out docs/src/validation/explain-stories.md

bench: ## Criterion benches
	cargo bench -p anergy-benches

bench-thermal: ## Times of whole runs with heat: DESTEST 256 days, 1 000 consumers one year, steps of 100 to 10 000, a year of 1 000 valves (over an hour)
	cargo build --release -p anergy-benches --bin thermal
	target/release/thermal destest $${ANERGY_REFERENCE_DATA:-../shared/data}/destest/definition
	target/release/thermal year 1000
	target/release/thermal steps 100 300 1000 3000 10000
	target/release/thermal valves 1000

bench-memory: ## Memory of a network of 100 000 edges by phase, of anergy solve, of a state
	cargo build --release -p anergy -p anergy-benches --bin anergy --bin memory
	target/release/memory tables 32500 target/network-of-100000-edges
	target/release/memory folder target/network-of-100000-edges
	target/release/memory text 32500
	target/release/memory state 1000
	/usr/bin/time -v target/release/anergy solve target/network-of-100000-edges/model.toml 2>&1 | tail -24 | grep Maximum

bench-peers: .venv-peers/.installed ## Hydraulics beside EPANET and pandapipes
	cargo build --release -p anergy -p anergy-benches --bins
	.venv-peers/bin/python benches/peers/speed.py

bench-ensemble: ## Threads, throughput and memory of ensembles: 1 000 days of three houses, 200 winter weeks of a town
	cargo build --release -p anergy
	$(PYTHON) benches/ensemble/run.py

instructions: ## Instructions of one warm solve with 1 000 edges (needs valgrind)
	cargo build --release -p anergy-benches --bin warm_solve
	@count() { valgrind --tool=callgrind --callgrind-out-file=/dev/null \
		target/release/warm_solve 1000 $$1 2>&1 | sed -n 's/.*Collected : *//p'; }; \
	echo "$$(( ($$(count 200) - $$(count 0)) / 200 )) instructions"

demo: ## The main job on the embedded study
	cargo run --release -- demo

clean: ## Remove what was built
	cargo clean
	rm -rf $(VENV) .venv-peers .venv-heat .venv-learn results
