# Each target creates .venv on first use. This needs Python >= 3.11 with venv and pip.
PYTHON ?= python3
VENV := .venv
BIN := $(VENV)/bin
READY := $(VENV)/.ready
# Commands that solve and draw need fewer packages than the tests; a complete environment serves both.
RUNTIME := $(if $(wildcard $(READY)),$(READY),$(VENV)/.runtime)
# One process per core with one thread each; the tests of a file share what they prepare.
# A process that dies is not replaced, so that the run ends with a message instead of waiting.
PARALLEL := OMP_NUM_THREADS=1 $(BIN)/python -m pytest -n auto --dist loadfile --max-worker-restart 0

# Tests that are sensitive to rounding, which depends on the order of sums and so on the processor.
KERNELS := Haswell Nehalem
FRAGILE := $(addprefix tests/backends/test_, interior_point.py scipy.py regularised.py ipopt_static.py clarabel_regularised.py) \
	$(addprefix tests/lacore/, coupling/test_intervals.py coupling/test_soils.py coupling/claims/test_claims.py solvers/inner/test_strong_bodies.py \
	solvers/inner/test_light_blocks.py bounds/test_static_bound.py bounds/test_kinematic_bound.py \
	paths/test_sequential.py paths/test_path_states.py paths/test_path_drift.py) \
	$(addprefix tests/verification/, conformance/test_conformance.py cases/test_path_cases.py report/test_reference_report.py)

.PHONY: help compare verify fuzz test test-slice test-all test-kernels test-browser test-site test-wheel mutants lint bench bench-all bench-page readme architecture reference docs results clean

help:
	@echo "make compare   compare all applicable backends on every case, and write reports/compare/index.html"
	@echo "make test      run the tests"
	@echo "make test-slice  run the slow tests of today, at most 12 minutes of them"
	@echo "make test-all  run the slow tests too"
	@echo "make verify    check every case: values, bounds, residuals, orders of convergence, brackets"
	@echo "make fuzz      check 1 000 random problems independently of the solver"
	@echo "make test-kernels   run tests that are sensitive to rounding under the BLAS kernels of other processors"
	@echo "make test-browser   open a report in Chromium; fails if it is not installed"
	@echo "make test-site   build the site without pictures, check its links, open it in Chromium"
	@echo "make test-wheel   install the wheel in a clean environment for each installed Python, and try it"
	@echo "make mutants   inject errors one at a time, and report which of them the fast tests do not notice"
	@echo "make lint      check formatting, lint and types"
	@echo "make bench     run the benchmarks (20 minutes) and append records to reports/benchmarks.jsonl"
	@echo "make bench-all   run the long benchmarks too, several minutes each"
	@echo "make bench-page   write docs/benchmarks.md, its data and its picture from these records"
	@echo "make readme    write the table, the times and the pictures of README and guide"
	@echo "make architecture   draw the packages and their imports for docs/architecture.md"
	@echo "make reference  write the committed report under reports/reference"
	@echo "make docs      build the site: reports/site/html/index.html"
	@echo "make results   run verify, and keep the results that the verification manual shows"
	@echo "make clean     remove the environment and all generated reports"
	@sed -n '/<!-- times -->/,/<!-- end times -->/{//!p}' README.md

# pip does not compile the packages, because few of their modules are ever imported. Processor time
# of the set-up and then `lacore`, `lacore new`, `lacore solve` and `lacore backends`, measured on two cores:
#                                 --no-compile   compiled
#   bytecode is written               61 s         85 s
#   PYTHONDONTWRITEBYTECODE is set    59 s         78 s
# Targets write bytecode even if the variable is set: a first solve takes 13 s without it, and 7 s with it.
unexport PYTHONDONTWRITEBYTECODE

$(READY): INSTALLED := .[dev]
$(VENV)/.runtime: INSTALLED := .
$(READY) $(VENV)/.runtime: pyproject.toml constraints.txt
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11) and "lacore needs Python 3.11 or newer: make PYTHON=python3.11")'
	@echo "Creating the Python environment $(VENV)"
	@$(PYTHON) -m venv $(VENV)
	@echo "Installing lacore and the packages pinned in constraints.txt (a minute or two)"
	@$(BIN)/python -m pip install --quiet --disable-pip-version-check --no-compile \
		--constraint constraints.txt --editable '$(INSTALLED)'
	@touch $@

compare: $(RUNTIME)
	@echo "Comparing the solvers on all cases; the report is written to reports/compare/index.html"
	@$(BIN)/lacore compare --out reports/compare

verify: $(RUNTIME)
	$(BIN)/lacore verify --out reports/verify

fuzz: $(RUNTIME)
	$(BIN)/lacore fuzz --count 1000 --out reports/fuzz

test: $(READY)
	$(PARALLEL) $(PYTEST_ARGS)

test-slice: $(READY)
	$(PARALLEL) -m slow --slice today $(PYTEST_ARGS)

test-all: $(READY)
	$(PARALLEL) -m "slow or not slow"

test-kernels: $(READY)
	for kernel in $(KERNELS); do echo "$$kernel:"; \
	  OPENBLAS_CORETYPE=$$kernel $(PARALLEL) $(FRAGILE) || exit 1; done
	for kernel in $(KERNELS); do OPENBLAS_CORETYPE=$$kernel $(BIN)/lacore compare vertical-cut \
	  --backends slsqp,newton,ipopt --meshes coarse --fresh --out reports/kernels || exit 1; done

test-browser: $(READY)
	$(BIN)/python -m pytest tests/verification/report/test_page_browser.py --require-browser

test-site: $(READY)
	$(PARALLEL) -m "slow or not slow" $(PYTEST_ARGS) tests/test_site.py \
		tests/test_guide.py::test_quick_code_runs_as_printed tests/verification/report/test_page_browser.py

test-wheel: $(READY)
	$(BIN)/python -m pytest tests/test_wheel.py -m "slow or not slow" -rs

mutants: $(READY)
	$(BIN)/python -m tests.mutants $(MUTANTS_ARGS)

lint: $(READY)
	$(BIN)/ruff check .
	$(BIN)/ruff format --check .
	$(BIN)/mypy

# One process per file, and one line per record as soon as it exists, so that a crash loses little.
# Exit code 5 means that BENCH_ARGS selects nothing in a file. The previous records are kept.
BENCH = $(BIN)/python -m pytest -q -rs --benchmark-enable --benchmark-only --benchmark-columns=min \
	--benchmark-sort=name --records $(RECORDS) -m
RECORDS := reports/benchmarks.jsonl
bench: CHOSEN := not dear
bench-all: CHOSEN := slow or not slow
bench bench-all: $(READY)
	mkdir -p reports; if [ -f $(RECORDS) ]; then mv $(RECORDS) reports/benchmarks-before.jsonl; fi
	failed=; for file in tests/benchmarks/test_*.py; do \
	  $(BENCH) "$(CHOSEN)" $(BENCH_ARGS) $$file || [ $$? -eq 5 ] || failed="$$failed $$file"; done; \
	$(BIN)/python docs/site/benchmarks.py $(RECORDS); \
	test -z "$$failed" || { echo "failed:$$failed"; exit 1; }

bench-page: $(READY)
	$(BIN)/python docs/site/benchmarks.py $(RECORDS) --page

readme: $(READY)
	$(BIN)/python docs/refresh.py

architecture: $(READY)
	$(BIN)/python docs/architecture.py

reference: $(READY)
	$(BIN)/python docs/reference_report.py

docs: $(READY)
	$(BIN)/python docs/site/build.py

results: verify
	$(BIN)/python docs/site/results.py reports/verify

clean:
	git clean -fdX reports
	rm -rf $(VENV)
