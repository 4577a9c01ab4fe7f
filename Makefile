# make (that is, make prove), make check, make test: each alone does everything it needs, from a
# fresh clone.

PYTHON = python3
VENV = .venv
SANITIZED = .venv-sanitize
SOURCES = $(wildcard csrc/* csrc/*/* converse/*.py converse/*/*.py) setup.py pyproject.toml MANIFEST.in
# -UNDEBUG: Python's own flags turn assertions off.
SANITIZE = -UNDEBUG -fsanitize=address,undefined -fno-sanitize-recover=undefined \
    -fno-omit-frame-pointer -g -O1

# Two processes, for as many cores; who is done first takes of the other's tests.
TWO = -n 2 --dist worksteal

PIP_INSTALL = pip install --quiet --disable-pip-version-check
PIP_FAILED = { echo 'pip failed. If it found no version of a package, the network or the package index' \
    'cannot be reached.' >&2; exit 1; }

# Installs $(2) into the virtual environment $(1).  One that was not finished, or not by these
# rules, is made anew; objects of an earlier build may have been compiled with other flags.  An
# earlier pip (Debian 11) installs nothing editable with today's setuptools.
define install
	sh .ci/packages $(PYTHON)
	test -e $@ || $(PYTHON) -m venv --clear $(1)
	rm -rf build/lib* build/temp* build/bdist*
	@echo 'Compiling and installing; pip says nothing until it is done.'
	@$(1)/bin/$(PIP_INSTALL) 'pip>=21.3' && $(1)/bin/$(PIP_INSTALL) $(2) || $(PIP_FAILED)
	touch $@
endef

.PHONY: prove check test lint format torture mutate accuracy gappa sanitize memcheck warnings \
    arm bench charts figures docs dist man clean formal formal-quick formal-check golden verified-check \
    checker compare packages

prove: $(VENV)/installed
	$(VENV)/bin/converse -d30 inputs/trig274.in
	@echo
	$(VENV)/bin/converse --method loewner inputs/trig274.in

# Asserts that explain themselves take as long to compile as a tenth of all tests takes to run.  So they
# are plain, and the tests that fail run once more with them.
PYTEST = $(VENV)/bin/pytest
AGAIN = { $(PYTEST) -q --last-failed --last-failed-no-failures none tests; exit 1; }

# The tests except the slow ones, a share of every room (tests/conftest.py), with a third of the random
# cases.  The first run also downloads the test tools.
check: export CONVERSE_TORTURE = 1/3
# What the first process compiles hundreds of others read.
check test: export PYTHONDONTWRITEBYTECODE =
check: $(VENV)/with-test
	$(PYTEST) $(TWO) -q -m 'not slow' --assert=plain tests || $(AGAIN)

test: $(VENV)/with-test
	$(PYTEST) $(TWO) --assert=plain tests || $(AGAIN)

PYTHON_CODE = converse docs experiments formal golden_outputs setup.py tests
C_CODE = $(wildcard csrc/*.h csrc/*/*.[ch] csrc/*/*.inc tests/kernels/*.[ch])

# What pyproject.toml says of style, imports and types, and .clang-format of C.
lint: $(VENV)/with-test
	$(VENV)/bin/ruff check --quiet $(PYTHON_CODE)
	$(VENV)/bin/isort --quiet --check $(PYTHON_CODE)
	$(VENV)/bin/mypy
	$(VENV)/bin/clang-format --dry-run -Werror $(C_CODE)
	! grep -nE '.{101}' $(C_CODE)

format: $(VENV)/with-test
	$(VENV)/bin/clang-format -i $(C_CODE)

# A hundred times as many random cases; hours.
torture: $(VENV)/with-test
	CONVERSE_TORTURE=100 $(VENV)/bin/pytest $(TWO) --timeout 0 tests

# Makes small mistakes in the core, a sample of them that SEED draws, and sees whether a test notices;
# half an hour.
mutate: $(VENV)/with-test
	$(VENV)/bin/python tests/mutate --sample 40 --seed $(or $(SEED),0)

# Reports and trees of the inputs, with those of golden_outputs/.
compare: $(VENV)/installed
	$(VENV)/bin/python golden_outputs/compare.py

# The table of proven bounds and worst errors, measured anew.
accuracy: $(VENV)/with-test
	PYTHONPATH=tests/loewner:tests/thesis $(VENV)/bin/python tests/accuracy.py > docs/development/accuracy.md

# What sine.h promises, proved from its text by Gappa, whose proofs Coq checks, and other margins for
# roundings, from theirs; a minute.
gappa: $(VENV)/installed
	sh .ci/packages $(PYTHON) gappa coq libcoq-gappa
	$(VENV)/bin/python formal/gappa.py --coq
	$(VENV)/bin/python formal/roundings.py

# A proof, the kernels and a failing proof under valgrind's memcheck.
memcheck: $(VENV)/installed
	$(VENV)/bin/python tests/kernels/build.py
	PYTHONMALLOC=malloc valgrind -q --error-exitcode=9 --suppressions=tests/memcheck.supp $(VENV)/bin/python tests/memcheck.py

# The rooms whose tests call the core in ways of their own.  The other rooms ask nothing else of it, and
# sanitizers find nothing in Python, figures, reports, tables or the texts of roundings.  The prover
# hands searches to the core, as search does; only there maps of three angles are searched.
# Orbits of thousands of points are followed as those of hundreds; test_the_longest_orbits follows some.
# SHARE="not slow" takes the share of them that make check takes.
SANITIZED_TESTS = $(addprefix tests/, arith loewner orbits prover/test_three_angles.py search thesis) \
    $(addprefix --ignore=tests/, loewner/test_margins.py orbits/test_pictures.py) \
    -k 'not long_call and not are_long_only'

# Safe path: the clone, where this starts, holds a core without sanitizers.
sanitize: export CFLAGS = $(SANITIZE)
sanitize: export LDFLAGS = -fsanitize=address,undefined
sanitize: $(SANITIZED)/installed
	$(SANITIZED)/bin/python tests/kernels/build.py
	PYTHONSAFEPATH=1 LD_PRELOAD="$$(gcc -print-file-name=libasan.so) $$(gcc -print-file-name=libstdc++.so.6)" ASAN_OPTIONS=detect_leaks=0 \
	UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 $(SANITIZED)/bin/pytest $(TWO) $(if $(SHARE),-m '$(SHARE)') $(SANITIZED_TESTS)

# The core's translation units.
UNITS = $(shell $(VENV)/bin/python -c 'exec(open("converse/_build.py").read()); print(*SOURCES)')

# The same tree on another kind of machine, emulated: needs gcc-aarch64-linux-gnu, qemu-user and
# libgmp-dev:arm64.
TREE_FLAGS = -std=c11 -O2 -ffp-contract=off -fno-math-errno -Icsrc
TREE_CORE = $(filter-out csrc/orbits/%, $(UNITS))
arm: tests/tree.c $(VENV)/installed
	@mkdir -p build
	gcc $(TREE_FLAGS) tests/tree.c $(TREE_CORE) -lgmp -lm -o build/tree
	aarch64-linux-gnu-gcc $(TREE_FLAGS) tests/tree.c $(TREE_CORE) -lgmp -lm -o build/tree-arm
	for problem in "0.25 0.25 0.5 0.0625 0.0625 0.125 1" "0.27 0.27 0.54 0.03 0.03 0.06 0"; do \
	    build/tree $$problem > build/tree.out && \
	    qemu-aarch64 -L /usr/aarch64-linux-gnu build/tree-arm $$problem | cmp - build/tree.out || exit 1; \
	done

bench: $(VENV)/installed
	$(VENV)/bin/python experiments/bench

charts: $(VENV)/with-plot
	$(VENV)/bin/python experiments/chart.py build

# The pictures of docs/ that docs/figures.csv lists, all or those of NAMES="...", drawn anew.
figures: $(VENV)/with-orbits $(VENV)/with-plot
	$(VENV)/bin/python docs/figures.py $(NAMES)

# The site, from the pages of docs/: build/docs/index.html.  A warning is an error.
docs: $(VENV)/with-docs
	$(VENV)/bin/sphinx-build -q -W --keep-going -j 2 docs build/docs

# The source distribution and a wheel, which are then tried in an environment of their own.  The wheel
# is for this machine: it needs the GMP library of the system, and serves every CPython from 3.9 on.
dist: $(VENV)/with-dist
	rm -rf dist build/dist
	$(VENV)/bin/pyproject-build >build/dist.log 2>&1 || { tail build/dist.log; exit 1; }
	$(VENV)/bin/twine check --strict dist/*
	$(PYTHON) -m venv build/dist
	build/dist/bin/$(PIP_INSTALL) dist/*.whl
	cd build/dist && bin/converse -b trig274.proof $$(bin/converse --list-inputs | grep trig274) \
	    >/dev/null && bin/converse-check --quiet trig274.proof
	@echo 'dist/ has both; the wheel proved and checked a theorem.'

# Manual pages and completions, from the commands' own parsers.
man: $(VENV)/with-man
	$(VENV)/bin/python docs/manual.py

FORMAL_PACKAGES = coq libcoq-interval ocaml ocaml-findlib libcoq-core-ocaml-dev libsha-ocaml-dev
# Two processes, unless make was asked for some.
FORMAL = $(MAKE) -C formal $(if $(filter -j%,$(MAKEFLAGS)),,-j2)

# Of the system, for all that .ci/run makes.
packages:
	sh .ci/packages $(PYTHON) $(FORMAL_PACKAGES) gappa libcoq-gappa

# The theorems that Coq believes: each as it is stated, what it assumes, what it took.
formal: $(VENV)/installed
	sh .ci/packages $(PYTHON) $(FORMAL_PACKAGES)
	+$(FORMAL) theorems

# Three theorems, one of each kind of numbers, the circle below, and the checker that Coq has proved.
formal-quick: $(VENV)/installed
	sh .ci/packages $(PYTHON) $(FORMAL_PACKAGES)
	+$(FORMAL) quick build/converse-verified

# The invariant circle of the standard map with k = 0.8; a minute.
golden: $(VENV)/installed
	sh .ci/packages $(PYTHON) $(FORMAL_PACKAGES)
	+$(FORMAL) golden

# The library's functors and a theorem once more, by Coq's second checker; minutes.
formal-check: $(VENV)/installed
	sh .ci/packages $(PYTHON) $(FORMAL_PACKAGES)
	+$(FORMAL) check

# The checker that Coq has proved.
verified-check:
	sh .ci/packages $(PYTHON) $(FORMAL_PACKAGES)
	+$(FORMAL) build/converse-verified
	@echo 'The checker is formal/build/converse-verified.'

# The checker as one file that Python runs and that can be mailed; Python is enough.
checker:
	rm -rf build/checker
	mkdir -p build/checker
	cp -R converse/check build/checker/converse_check
	rm -rf build/checker/converse_check/__pycache__
	printf 'import sys\n\nfrom converse_check import main\n\nif __name__ == "__main__":\n    sys.exit(main())\n' \
	    > build/checker/__main__.py
	$(PYTHON) -m zipapp -c -p '/usr/bin/env python3' -o build/converse-check.pyz build/checker
	@echo 'build/converse-check.pyz is the checker: python3 build/converse-check.pyz FILE'

# Every translation unit that converse/_build.py lists, with all warnings as errors: with -O1, which follows
# the flow of a function as -O2 does, and takes a fifth of the time.
warnings: $(VENV)/installed
	for source in $(UNITS); do \
	    echo $$source; \
	    gcc -std=c11 -O1 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Werror -Icsrc \
	        -c $$source -o /dev/null || exit 1; \
	done

# Editable: Python started in the clone, or anywhere with this environment, sees these very files.
# With numpy, as converse-check is much slower without.
$(VENV)/installed: $(SOURCES)
	$(call install,$(VENV),--editable '.[check]')

# What an extra of pyproject.toml adds to it.
$(VENV)/with-%: $(VENV)/installed
	@echo 'Installing what the extra "$*" needs; pip says nothing until it is done.'
	@$(VENV)/bin/$(PIP_INSTALL) 'converse-kam[$*]' || $(PIP_FAILED)
	touch $@

# Not editable: its core has other flags and must not take the other one's place in the clone.
$(SANITIZED)/installed: export CFLAGS = $(SANITIZE)
$(SANITIZED)/installed: export LDFLAGS = -fsanitize=address,undefined
$(SANITIZED)/installed: $(SOURCES)
	$(call install,$(SANITIZED),'.[test]')

clean:
	rm -rf build dist *.egg-info $(VENV) $(SANITIZED) .pytest_cache .hypothesis
	rm -f converse/_native.*
	rm -rf formal/build formal/*.vo formal/*.vo[ks] formal/*.glob formal/.*.aux formal/.*.cache
	find . -name __pycache__ -prune -exec rm -rf {} +
