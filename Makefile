# make demo   train the draft finger, grasp, verify, report to out/demo
# make test   tests, lint, types, import contracts; make test-long  the repetitions of faults, and what takes long
# make readme, solver, training, surrogate, control, tradeoff, extremes, required, figures   what README and docs/ show (see below)
# make model  rom/finger.h5, the trained finger that comes with the repository; make wheel  dist/*.whl
# make bench  the short form of all studies, compared with docs/bench.json
# make clean  remove what the others made (the built environment stays)
PYTHON ?= python3
BOTH_CORES = -n 2 --dist loadfile
COMPILER = command -v $${CC:-cc} >/dev/null || command -v gcc >/dev/null || command -v clang >/dev/null
AS_ROOT = [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null

.PHONY: demo test test-long clean model wheel readme solver training surrogate control tradeoff extremes required bench figures

demo:
	docker/run python3 studies/demo.py out/demo

# The tests in the environment train the draft finger once, in out/tests; those without DOLFINx use it again.
test: .venv/ready
	rm -rf out/tests
	docker/run python3 studies/demo.py out/tests
	docker/run python3 -m pytest -q $(BOTH_CORES) tests/fingerfem tests/studies
	docker/run mpirun -n 2 python3 -m pytest -q -m mpi
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/mypy
	.venv/bin/lint-imports
	OPENBLAS_NUM_THREADS=1 .venv/bin/python -m pytest -q $(BOTH_CORES) tests/rom tests/control tests/packaging

# Faults once more, under every kind of lock and kill; a thousand solves; rom and control with the environment's packages.
test-long: out/tests/report.json
	docker/run python3 -m pytest -q $(BOTH_CORES) -m long
	docker/run python3 -m pytest -q $(BOTH_CORES) tests/rom tests/control

out/tests/report.json:
	docker/run python3 studies/demo.py out/tests

# README's numbers and picture, from the last demo.
readme: demo
	docker/run python3 studies/readme.py out/demo

# rom/finger.h5, the trained finger that comes with the repository: some twenty minutes on two cores; it resumes.
model:
	docker/run mpirun -n 2 python3 -m fingerfem snapshots scenes/standard.toml out/model/training
	docker/run mpirun -n 2 python3 -m fingerfem snapshots scenes/standard.toml out/model/heldout --random 50 --distances 4 --seed 2018
	docker/run python3 -m rom build out/model/training -o rom/finger.h5 --held-out out/model/heldout

# What a machine without a C compiler installs: dist/*.whl.
wheel:
	$(PYTHON) -m pip wheel -q --disable-pip-version-check --no-deps -w dist .

# docs/solver.md, from the studies of the full-order solver: about an hour on one core.
solver:
	docker/run env OMP_NUM_THREADS=1 python3 studies/solver/solver.py out/solver
	docker/run env OMP_NUM_THREADS=1 python3 studies/solver/choices.py out/solver
	docker/run env OMP_NUM_THREADS=1 python3 studies/solver/scenes.py out/solver
	docker/run python3 studies/solver/page.py out/solver

# docs/training.md, from the studies of the farm, about half an hour; docs/solver.md's study must have run before.
training:
	docker/run python3 studies/training/training.py out/farm
	docker/run python3 studies/training/refinement.py out/farm
	docker/run python3 studies/training/page.py out/farm out/solver/solver.json

# docs/surrogate.md, from the studies of the surrogate, about two hours; other packages come from PyPI, in an environment beside.
surrogate:
	docker/run python3 studies/surrogate/surrogate.py out/surrogate
	docker/run python3 studies/surrogate/growth.py out/surrogate
	docker/run python3 studies/surrogate/two_meshes.py out/surrogate
	$(PYTHON) -m venv out/surrogate/others
	out/surrogate/others/bin/python -m pip install -q --disable-pip-version-check -e . ezyrb tensorly
	out/surrogate/others/bin/python studies/surrogate/others.py out/surrogate
	docker/run python3 studies/surrogate/page.py out/surrogate

# docs/control.md, from the sets of the surrogate's study, which are solved if they are not there; half an hour besides.
control:
	docker/run python3 studies/control/control.py out/control
	docker/run python3 studies/control/page.py out/control

# docs/tradeoff.md and the front that accuracy, budget and presets choose from: some two hours on two cores; it resumes.
tradeoff:
	docker/run python3 studies/tradeoff/tradeoff.py out/tradeoff
	docker/run python3 studies/tradeoff/page.py out/tradeoff

# docs/extremes.md: the ends of every range; some twenty minutes.
extremes:
	docker/run python3 studies/extremes/extremes.py out/extremes
	docker/run python3 studies/extremes/page.py out/extremes

# docs/required.md: what each kind of scene costs; some twenty minutes.
required:
	docker/run python3 studies/required/required.py out/required
	docker/run python3 studies/required/page.py out/required

# What differs from docs/bench.json, if anything; some forty minutes.
bench:
	docker/run python3 studies/bench.py out/bench

# The pictures of docs/figures.md: free states, contact states, two segments, as figures 3, 4 and 6 of the paper.
figures:
	docker/run python3 -m fingerfem render scenes/one_segment.toml docs/free.png \
	    --case 'F1=50' --case 'F1=100' --case 'F1=50 F2=50' --case 'F1=100 F2=100'
	docker/run python3 -m fingerfem render scenes/one_segment.toml docs/contact.png \
	    --case 'F1=50 d=0.005' --case 'F1=100 d=0.005' --case 'F1=50 F2=50 d=0.005' --case 'F1=100 F2=50 d=0.015'
	docker/run python3 -m fingerfem render scenes/two_segments.toml docs/two_segments.png \
	    --case 'F_l=40' --case 'F_s=40' --case 'F_s=20 F_l=20 d=0.03' --case 'F_s=40 F_l=40 d=0.03'

# A plain virtual environment of this machine's Python, with a C compiler, without DOLFINx.
.venv/ready: pyproject.toml
	@$(PYTHON) -c 'import sys; sys.exit(sys.version_info < (3, 11))' 2>/dev/null || ! command -v $(PYTHON) >/dev/null \
	    || { echo "make test needs Python 3.11 or newer, got $$($(PYTHON) -V); name another by PYTHON=" >&2; exit 2; }
	@$(PYTHON) -c 'import ensurepip, venv' 2>/dev/null || { $(AS_ROOT) && apt-get update -q && apt-get install -qy --no-install-recommends python3-venv; } \
	    || { echo "make test needs $(PYTHON) with venv (Debian: python3-venv)" >&2; exit 2; }
	@$(COMPILER) || { $(AS_ROOT) && apt-get update -q && apt-get install -qy --no-install-recommends gcc libc6-dev; } && $(COMPILER) \
	    || { echo "make test needs a C compiler (Debian: gcc libc6-dev)" >&2; exit 2; }
	$(PYTHON) -m venv .venv
	.venv/bin/python -m pip install -q --disable-pip-version-check -e '.[dev]'
	touch $@

clean:
	rm -rf out dist build .venv .cache *.egg-info .mypy_cache .ruff_cache .hypothesis .import_linter_cache
	find . -name __pycache__ -not -path './.git/*' -prune -exec rm -rf {} +
