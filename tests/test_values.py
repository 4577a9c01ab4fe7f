"""Our frozen classes are dataclasses in all that can be seen of them."""

import copy
import dataclasses
import inspect
import pickle
import subprocess
import sys
from typing import Dict, Optional, Tuple

import pytest

from converse import Counts, Problem, Proof, Settings, values


def declare(dataclass, field):
    @dataclass(frozen=True)
    class Value:
        a: int
        b: Tuple[int, ...] = (1, 2)
        c: Dict[str, int] = field(default_factory=dict)
        d: float = field(default=0.5, compare=False)
        e: Optional[str] = None

        def __post_init__(self):
            if self.a < 0:
                object.__setattr__(self, "a", 0)

    return Value


class Kept(declare(values.dataclass, values.field)):
    """Where pickle finds it."""


OURS = declare(values.dataclass, values.field)
THEIRS = declare(dataclasses.dataclass, dataclasses.field)
GIVEN = [((1,), {}), ((-1, (3,)), {"d": 2.5}), ((), {"a": 7, "c": {"x": 1}, "e": "e"}),
         ((1, (), {}, 3.5, "f"), {})]
WRONG = [((), {}), ((1, 2, 3, 4, 5, 6), {}), ((1,), {"a": 1}), ((1,), {"z": 1}), ((), {"b": ()})]


@pytest.mark.parametrize("given, named", GIVEN)
def test_made_alike(given, named):
    ours, theirs = OURS(*given, **named), THEIRS(*given, **named)
    assert repr(ours) == repr(theirs)
    assert vars(ours) == vars(theirs)
    assert dataclasses.asdict(ours) == dataclasses.asdict(theirs)
    for change in {"a": 9}, {"d": 9.5}, {"c": {"y": 2}, "e": "g"}, {}:
        changed = dataclasses.replace(ours, **change)
        assert changed == values.replace(ours, **change) and type(changed) is OURS
        assert vars(changed) == vars(dataclasses.replace(theirs, **change))
        assert (changed == ours) == (dataclasses.replace(theirs, **change) == theirs)
    assert ours != theirs and ours != 1


@pytest.mark.parametrize("given, named", WRONG)
def test_refused_alike(given, named):
    for cls in OURS, THEIRS:
        with pytest.raises(TypeError):
            cls(*given, **named)


def test_seen_alike():
    assert [(x.name, x.type, x.default, x.default_factory, x.compare) for x in
            dataclasses.fields(OURS)] == [(x.name, x.type, x.default, x.default_factory, x.compare)
                                          for x in dataclasses.fields(THEIRS)]
    assert dataclasses.is_dataclass(OURS) and dataclasses.is_dataclass(OURS(1))
    assert inspect.signature(OURS) == inspect.signature(THEIRS)
    assert repr(OURS.__dataclass_params__) == repr(THEIRS.__dataclass_params__)
    assert OURS.__match_args__ == THEIRS.__match_args__ and (OURS.b, OURS.e) == ((1, 2), None)
    for cls in OURS, THEIRS:
        assert not hasattr(cls, "a") and not hasattr(cls, "c")
        with pytest.raises(dataclasses.FrozenInstanceError):
            cls(1).a = 2
        with pytest.raises(dataclasses.FrozenInstanceError):
            del cls(1).a
        with pytest.raises(TypeError):
            hash(cls(1))                # of its dictionary
    assert OURS(1).c is not OURS(1).c


def test_values_are_kept():
    value = Kept(3, e="x")
    assert pickle.loads(pickle.dumps(value)) == copy.deepcopy(value) == value
    assert hash(Settings()) == hash(Settings("thesis")) and len({Counts(), Counts(tries=0)}) == 1


def test_ours():
    """The public ones, one of each."""
    problem = Problem("1", "2", ("3", "4"))
    proof = Proof(problem)
    for value in problem, Settings(), Counts(), proof:
        names = [x.name for x in dataclasses.fields(value)]
        assert list(inspect.signature(type(value)).parameters) == names
        assert dataclasses.replace(value) == value
        assert pickle.loads(pickle.dumps(value)) == value
    assert dataclasses.replace(proof, seconds=3.0) == proof != dataclasses.replace(proof, tree="P")


def test_the_command_does_without():
    """What takes long to import is not imported for a proof that takes a millisecond."""
    code = ("import sys; from converse.cli import main; sys.argv = ['', '--method', 'loewner',"
            "'--together']; main(); print({'dataclasses', 'inspect', 'concurrent.futures',"
            "'logging', 'shutil'} & set(sys.modules), file=sys.stderr)")
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True,
                          input="0.31 0\n0.31 0\n0.62 0\n1 1\n1 1\n")
    assert "I find no invariant tori" in done.stdout and done.stderr == "set()\n"
