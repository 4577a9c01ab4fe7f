# make prove, make test: each alone does everything it needs, from a fresh clone.

PYTHON = python3
VENV = .venv
SANITIZED = .venv-sanitize
SOURCES = $(wildcard csrc/* csrc/*/* converse/*.py) setup.py pyproject.toml MANIFEST.in
SANITIZE = -fsanitize=address,undefined -fno-sanitize-recover=undefined -fno-omit-frame-pointer -g -O1

# Installs the package with its tests' needs into a virtual environment; $(1) is that directory.
# Objects of an earlier build may have been compiled with other flags, so they go first.
define install
	sh .ci/packages $(PYTHON)
	test -x $(1)/bin/pip || $(PYTHON) -m venv --clear $(1)
	rm -rf build/lib* build/temp* build/bdist*
	$(1)/bin/pip install --quiet --disable-pip-version-check '.[test]'
	touch $(1)/stamp
endef

.PHONY: prove test torture mutate accuracy sanitize memcheck warnings bench charts clean

prove: $(VENV)/stamp
	@mkdir -p build
	$(VENV)/bin/converse -d30 -g build/trig274.ps inputs/trig274.in
	@echo 'The figure of the prisms is build/trig274.ps.'

test: $(VENV)/stamp
	$(VENV)/bin/pytest tests

# A hundred times as many random cases; hours.
torture: $(VENV)/stamp
	CONVERSE_TORTURE=100 $(VENV)/bin/pytest tests

# Breaks the C core in one place after another and sees whether a test notices; half an hour.
mutate: $(VENV)/stamp
	$(VENV)/bin/python tests/mutate.py

# The table of proven bounds and worst errors, measured anew.
accuracy: $(VENV)/stamp
	$(VENV)/bin/python tests/accuracy.py > docs/accuracy.md

# A proof, the kernels and a failing proof under valgrind's memcheck.
memcheck: $(VENV)/stamp
	PYTHONMALLOC=malloc valgrind -q --error-exitcode=9 --suppressions=tests/memcheck.supp $(VENV)/bin/python tests/memcheck.py

sanitize: $(SANITIZED)/stamp
	LD_PRELOAD="$$(gcc -print-file-name=libasan.so) $$(gcc -print-file-name=libstdc++.so.6)" ASAN_OPTIONS=detect_leaks=0 \
	UBSAN_OPTIONS=halt_on_error=1:print_stacktrace=1 $(SANITIZED)/bin/pytest tests

bench: $(VENV)/stamp
	$(VENV)/bin/python tests/bench

charts: $(VENV)/stamp
	$(VENV)/bin/converse-chart docs

# Every translation unit that converse/_build.py lists, with all warnings as errors.
warnings: $(VENV)/stamp
	$(VENV)/bin/python -c 'exec(open("converse/_build.py").read()); print(*SOURCES, sep="\n")' \
	| while read source; do \
	    echo $$source; \
	    gcc -std=c11 -O2 -ffp-contract=off -Wall -Wextra -Wpedantic -Wconversion -Werror -Icsrc \
	        -c $$source -o /dev/null || exit 1; \
	done

$(VENV)/stamp: $(SOURCES)
	$(call install,$(VENV))

$(SANITIZED)/stamp: export CFLAGS = $(SANITIZE)
$(SANITIZED)/stamp: export LDFLAGS = -fsanitize=address,undefined
$(SANITIZED)/stamp: $(SOURCES)
	$(call install,$(SANITIZED))

clean:
	rm -rf build dist *.egg-info $(VENV) $(SANITIZED) .pytest_cache .hypothesis
	find . -name __pycache__ -prune -exec rm -rf {} +
