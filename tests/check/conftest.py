import random
from fractions import Fraction

import pytest
from conftest import around

from converse import StandardMap, prove, read_input, tori
from converse.diagram import Diagram
from converse.model.map import LINE

from checker import check, says_the_same
from trees import INPUTS, built
from truth import TORTURE

BOUNDS = {}             # found by torus_bound in this process, by what was asked


@pytest.fixture(scope="module", autouse=True)
def bounds_once():
    """Bounds B over the torus once where several tests ask for the same."""
    torus_bound = check.torus_bound

    def bound(fixed, waves, corners):
        key = fixed.bits, tuple(waves), tuple(sorted(set(corners)))
        if key not in BOUNDS:
            BOUNDS[key] = torus_bound(fixed, waves, corners)
        return BOUNDS[key]

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(check, "torus_bound", bound)
        yield


@pytest.fixture(scope="session")
def diagram():
    """A diagram of the standard map, as text: proofs for two ranges, and the golden circle for
    another."""
    found = Diagram.of(StandardMap((0, 2)))
    for ends in ("1.2", "1.3"), ("1.6", "1.7"):
        found.add(prove(StandardMap(ends)))
    found.add(tori.prove(StandardMap(("0.1", "0.2")), "golden"))
    found.sides["above"] = Fraction("2.5"), (Fraction(1, 2), Fraction(0)), (1, 0)
    return found._text()


@pytest.fixture
def generator(request):
    return random.Random(request.node.name)


@pytest.fixture
def run(tmp_path, capsys):
    """Checks a text or bytes: (status, stdout, stderr).  A short proof file is checked by both
    checkers."""
    def run(data, *options, name="some.proof"):
        path = tmp_path / name
        data = data if isinstance(data, bytes) else data.encode("utf-8")
        path.write_bytes(data)
        status = check.main([*options, str(path)])
        out, err = capsys.readouterr()
        if data.startswith(b"converse proof 6") and len(data) < 20000 and not options:
            assert says_the_same(path, status, err)
        return status, out, err.replace(str(path), "FILE")      # its directory names the test
    return run


@pytest.fixture
def impatient(monkeypatch):
    """Fewer pieces than the checker would try in vain, with shorter orbits: of the fast path, and
    still fewer of the exact one, which halves them as often as ever, but not all of them.  And no
    line of progress that would depend on the clock."""
    monkeypatch.setattr(check, "LINE_SECONDS", 1e9)
    if TORTURE <= 1:
        excluded = check.Criterion.excluded

        def few(self, cell):
            with pytest.MonkeyPatch.context() as patch:
                patch.setattr(check, "MAX_PIECES", min(check.MAX_PIECES, 28))
                patch.setattr(check, "MAX_SITES", min(check.MAX_SITES, 30))
                return excluded(self, cell)

        monkeypatch.setattr(check, "MAX_PIECES", 128)
        monkeypatch.setattr(check, "MAX_SITES", 150)
        monkeypatch.setattr(check.Criterion, "excluded", few)


@pytest.fixture(scope="session")
def texts(root, tmp_path_factory):
    """The proof files of the four inputs, as text."""
    found = {}
    for name in INPUTS:
        path = tmp_path_factory.mktemp("proofs") / name
        prove(read_input(root / "inputs" / (name + ".in")), method="thesis").save(path)
        found[name] = path.read_text(encoding="utf-8")
    return found


@pytest.fixture(scope="session")
def deep(texts):
    """a = b = c/2 = 0.24: beyond the thesis's method; no leaf is settled at once."""
    return built("0.24", "0.0001", 30, texts["trig274"])


@pytest.fixture(scope="session")
def moving(tmp_path_factory):
    """Proof files of the method loewner, by name: parameters on a segment, that of the inputs or
    another, or in a box about a piece of it; with cuts of the parameters or without.  They are of
    the whole torus, in the frame in which leaves may be mirror images: what the program makes of
    it is in test_parts.py."""
    inputs = [LINE * k for k in (1, 1, 2)]          # times epsilon
    slanted = (Fraction(12), Fraction("10.5"), Fraction(23))
    found = {}
    for name, direction, low, high, together in (
            ("segment", inputs, "0.0200", "0.0280", True),
            ("beginning", inputs, "0.0200", "0.0202", True),
            ("slanted", slanted, "0.0216", "0.0284", True),
            ("point", inputs, "0.0240", "0.0240", True),
            ("box", inputs, "0.0230", "0.0250", False),
            ("narrow box", inputs, "0.0239", "0.0241", False),
            ("slanted box", slanted, "0.0236", "0.0250", False)):
        ends = [[k * Fraction(x) for k in direction] for x in (low, high)]
        problem = around((*((p + q) / 2 for p, q in zip(*ends)), Fraction(1), Fraction(1)),
                          (*((q - p) / 2 for p, q in zip(*ends)), Fraction(1), Fraction(1)), (),
                          together)
        path = tmp_path_factory.mktemp("proofs") / "moving"
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("converse.prover.run.reduced", lambda problem, xstar: problem)
            prove(problem, method="loewner").save(path)
        found[name] = path.read_text(encoding="utf-8")
    return found


@pytest.fixture(scope="session")
def np():
    assert check.import_numpy_if_sound()
    return check.np
