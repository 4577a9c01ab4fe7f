"""Tests of experiments/, which no other code uses: `make torture` runs them."""

from truth import TORTURE

collect_ignore_glob = [] if TORTURE > 1 else ["test_*.py"]
