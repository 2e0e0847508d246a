# make demo   train a finger, grasp, verify, report to out/demo
# make test   tests, lint, types, import contracts; make test-long  the repetitions of faults, and what takes long
# make docs   measure anew what README and docs/ show; make readme  README's numbers alone; make peers  docs/peers.md alone
# make model  rom/finger.h5, the bundled finger; make silicone  the other two; make wheel  dist/*.whl
# make page   control/export/viewer.html, what `control export` writes models into
# make site   the documentation as a site, in out/site
# make bench  times, compared with those of the last commit that was measured
# make clean  remove what the others made (the built environment stays)
PYTHON ?= python3
BOTH_CORES = -n 2 --dist loadfile
COMPILER = command -v $${CC:-cc} >/dev/null || command -v gcc >/dev/null || command -v clang >/dev/null
# Where the numbers of a page are from: the commit, and whether the sources are changed since.
COMMIT = $$(git rev-parse --short HEAD)$$(git diff --quiet HEAD -- fingerfem/*.py fingerfem/*/*.py rom control scenes studies || echo ", changed")
MEASURED = docker/run env FINGERFEM_COMMIT="$(COMMIT)"
AS_ROOT = [ "$$(id -u)" = 0 ] && command -v apt-get >/dev/null

.PHONY: demo test test-long clean model silicone page wheel readme docs gallery peers site bench

demo:
	docker/run python3 studies/demo.py out/demo

# The tests in the environment solve the draft finger's sets once, in out/tests, and try the demo on coarse meshes, in
# out/tests/demo; those without DOLFINx use them again.
test: .venv/ready out/peers/felupe/ready out/peers/calculix/ready
	rm -rf out/tests
	$(MAKE) out/tests/ready
	docker/run python3 -m pytest -q $(BOTH_CORES) tests/fingerfem tests/studies tests/control/export/test_browser.py
	docker/run mpirun -n 2 python3 -m pytest -q -m mpi
	.venv/bin/ruff check .
	.venv/bin/ruff format --check .
	.venv/bin/mypy
	.venv/bin/lint-imports
	OPENBLAS_NUM_THREADS=1 .venv/bin/python -m pytest -q $(BOTH_CORES) tests/rom tests/control tests/packaging

# Faults once more, under every kind of lock and kill; a thousand solves; three hundred wrong files; the oldest and newest versions
# allowed; rom and control with the environment's packages; contact with the compiler's checks of memory and arithmetic.
SANITIZED = XDG_CACHE_HOME=$(CURDIR)/out/sanitized CC="gcc -g -fsanitize=address,undefined -fno-sanitize-recover=undefined" \
	LD_PRELOAD=$$(gcc -print-file-name=libasan.so) ASAN_OPTIONS=detect_leaks=0
test-long: .venv/ready out/tests/finer.ready
	docker/run python3 -m pytest -q $(BOTH_CORES) -m long tests/fingerfem tests/studies
	OPENBLAS_NUM_THREADS=1 .venv/bin/python -m pytest -q $(BOTH_CORES) -m long tests/rom tests/control tests/packaging
	docker/run python3 -m pytest -q $(BOTH_CORES) tests/rom tests/control
	$(SANITIZED) .venv/bin/python -m pytest -q tests/rom/rod/test_touch.py tests/rom/rod/test_several_objects.py tests/rom/rod/friction

out/tests/ready:
	mkdir -p out/tests
	sed '$$a store = ["displacement", "pad_pressure"]' scenes/draft.toml > out/tests/draft.toml
	docker/run mpirun -n 2 python3 -m fingerfem snapshots out/tests/draft.toml out/tests/training
	docker/run mpirun -n 2 python3 -m fingerfem snapshots out/tests/draft.toml out/tests/heldout --random 24 --seed 2018 --near out/tests/training
	docker/run python3 studies/demo.py out/tests/demo --quick
	touch $@

out/tests/finer.ready: out/tests/ready
	sed -e 's/cells = \[20, 5\]/cells = [10, 5]/' -e 's/order = 1/order = 2/' out/tests/draft.toml > out/tests/finer.toml
	docker/run mpirun -n 2 python3 -m fingerfem snapshots out/tests/finer.toml out/tests/finer --random 16 --seed 2019 --near out/tests/training
	touch $@

# README's numbers and picture, from the last demo.
readme: demo
	docker/run python3 studies/readme.py out/demo

# rom/finger.h5, the bundled finger: rod elements, trained in some 270 core-seconds; every state begins at the same one on a
# coarse mesh. 24 states of a finer mesh correct them, and 60 others measure errors and estimates, most of the time; it resumes.
SNAPSHOTS = docker/run mpirun -n 2 python3 -m fingerfem snapshots
model:
	$(SNAPSHOTS) scenes/demo/bundled.toml out/model/coarse --coarse
	$(SNAPSHOTS) scenes/demo/bundled.toml out/model/fine --near out/model/coarse
	$(SNAPSHOTS) scenes/demo/bundled_finest.toml out/model/finest --points scenes/demo/bundled_finest.csv --near out/model/coarse
	$(SNAPSHOTS) scenes/demo/plane_coarse.toml out/model/heldout-coarse --random 15 --distances 4 --seed 2020
	$(SNAPSHOTS) scenes/demo/plane_finest.toml out/model/heldout --random 15 --distances 4 --seed 2020 --near out/model/heldout-coarse
	docker/run python3 -m rom build out/model/fine --finer out/model/finest --held-out out/model/heldout -o rom/finger.h5

# rom/round.h5 and rom/square.h5, fingers of Dragon Skin 30 with weight: 120 states of a coarse mesh, and a few of a finer one that
# correct them. These begin at rest: nearly incompressible rubber does not settle from the field of a coarse mesh.
silicone: $(patsubst %,rom/%.h5,round square)
rom/%.h5: scenes/silicone/%_pressed.toml scenes/silicone/%_finest.toml scenes/silicone/%_finest.csv scenes/silicone/%.toml
	$(SNAPSHOTS) scenes/silicone/$*_pressed.toml out/silicone/$*
	$(SNAPSHOTS) scenes/silicone/$*_finest.toml out/silicone/$*-finest --points scenes/silicone/$*_finest.csv
	docker/run python3 -m rom build out/silicone/$* --finer out/silicone/$*-finest -o out/silicone/$*.h5
	docker/run python3 -m rom assemble scenes/silicone/$*.toml out/silicone/$*.h5 -o $@

# control/export/viewer.html, the page that `python3 -m control export` writes models into: three.js, and the C that Python calls as
# WebAssembly. Needs node and npm; a compiler for WebAssembly comes from PyPI.
page: .venv/ready
	.venv/bin/python -m pip install -q --disable-pip-version-check ziglang==0.17.1
	cd control/export/browser && npm ci --silent
	PYTHONPATH=. .venv/bin/python control/export/browser/build.py

# What a machine without a C compiler installs: dist/*.whl.
wheel:
	$(PYTHON) -m pip wheel -q --disable-pip-version-check --no-deps -w dist .

# All generated pages of docs/, README's numbers and the front that presets choose from: some one hour on two cores. What
# is measured is kept in out/docs, so that the same command goes on after an interruption; python3 -m studies.runner NAME makes one page.
# MuJoCo, whose pictures need EGL, and FElupe, which this package is compared with, come from PyPI.
docs: readme .venv/ready out/peers/felupe/ready
	@$(AS_ROOT) && apt-get install -qy --no-install-recommends libegl1 libgl1-mesa-dri libopengl0 >/dev/null || true
	$(MEASURED) python3 -m studies.runner --part engine/full_order
	OPENBLAS_NUM_THREADS=1 MUJOCO_GL=egl FINGERFEM_COMMIT="$(COMMIT)" .venv/bin/python -m studies.runner \
		--part engine/simulated $(foreach part,first second third fourth fifth sixth seventh eighth ninth tenth pictures real_time,--part grasping/$(part))
	$(MEASURED) python3 -m studies.runner
	$(MAKE) gallery

# The pictures of examples/ in docs/index.md.
gallery:
	for name in one_finger gripper lengths; do docker/run python3 examples/$$name.py docs/example_$$name.png || exit 1; done

# docs/peers.md alone.
peers: out/peers/felupe/ready
	$(MEASURED) python3 -m studies.runner peers

# FElupe, the other finite element code, runs in a process of its own; only that process looks into its folder.
out/peers/felupe/ready: .venv/ready
	.venv/bin/python -m pip install -q --disable-pip-version-check --upgrade --target out/peers/felupe --no-deps felupe==11.3.0 tensortrax==0.29.0
	touch $@

# CalculiX from Debian's or Ubuntu's packages, which are unpacked, not installed; without them its test is skipped.
out/peers/calculix/ready:
	rm -rf $(@D) && mkdir -p $(@D)
	@$(AS_ROOT) && apt-get update -qq || true
	cd $(@D) && apt-get download -q calculix-ccx libspooles2.2 libarpack2 || echo "no CalculiX: its test is skipped" >&2
	cd $(@D) && for package in *.deb; do [ ! -e "$$package" ] || dpkg -x "$$package" . || exit 1; done && rm -f *.deb
	[ ! -x $(@D)/usr/bin/ccx ] || touch $@

# The documentation as a site, out/site/index.html: no link may be broken. What its pages quote, docs/.site/samples.py makes anew.
site: out/site-venv/ready .venv/ready
	$(PYTHON) docs/.site/language.py
	NO_MKDOCS_2_WARNING=1 out/site-venv/bin/mkdocs build --strict
	PYTHONPATH=. .venv/bin/python -m control export rom/finger.h5 out/site/finger.html

out/site-venv/ready: docs/.site/requirements.txt
	$(PYTHON) -m venv out/site-venv
	out/site-venv/bin/python -m pip install -q --disable-pip-version-check -r docs/.site/requirements.txt
	touch $@

# Times of queries, contacts, holds and Newton iterations, beside those that this machine kept of an earlier commit, in .benchmarks.
bench:
	docker/run python3 -m pytest -q tests/benchmarks --benchmark-autosave --benchmark-compare --benchmark-columns=min,median,rounds

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
