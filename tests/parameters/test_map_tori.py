"""Tori that are proved along the rays of a map."""

from fractions import Fraction as F

import pytest
import rays
import vectors

from converse import check
from converse.commands import map as cli
from converse.draw import map_figure
from converse.model.map import THESIS, SymplecticMap
from converse.model.problem import Problem
from converse.parameters.map import ParameterMap
from converse.parameters.tori import proved_points
from converse.storage.files import ConverseError
from converse.tori import read_rotation


def t49(direction, estimate):
    return [(read_rotation("T49"), estimate)]


@pytest.fixture(scope="module")
def few(tmp_path_factory):
    """A map of a = b with an estimate in two directions, far below the frontier; and certificates
    of tori there."""
    found = ParameterMap.new("a=b", F(21, 20))
    found.estimate[:] = [{F(0): 0.06, F(1): 0.03}, {F(0): 0.09, F(1): 0.03}]
    directory = tmp_path_factory.mktemp("tori") / "ab.tori"
    directory.mkdir()
    rays.prove_tori(found, directory, t49, 1 << 15)
    assert len([*directory.iterdir()]) == 3         # the faces share a direction
    return found, directory


@pytest.mark.slow
def test_a_torus_is_proved_on_each_ray(few):
    found, directory = few
    points = proved_points(directory)
    assert {name for _, name in points} == {"T49"}
    for a, b, c in (point for point, _ in points):
        assert a == b and (a == 0 or c in (0, a)) and 0 < a + c
    assert sorted(max(point) for point, _ in points) == sorted([F("0.06"), F("0.03"), F("0.09")])


@pytest.mark.slow
def test_the_checker_confirms_them(few, capsys):
    for path in few[1].iterdir():
        assert check.main([str(path)]) == 0
    assert "invariant Lagrangian graph" in capsys.readouterr().out


@pytest.mark.slow
def test_what_is_there_is_not_proved_again(few, monkeypatch):
    monkeypatch.setattr(vectors, "highest", lambda *_: pytest.fail("asked again"))
    rays.prove_tori(*few, t49, 1 << 15)


def test_beyond_the_frontier_there_is_none():
    def at(radius):
        a = F(max(1, round(radius)))
        return Problem(SymplecticMap(THESIS, [a, a, F(0)]))

    assert vectors.highest(at, read_rotation("T49"), 40.0, 1 << 6) == (None, 0.0)


def test_the_highest_is_proved_where_it_can_be():
    """Beyond its break-up nothing is found, and lower values are tried; none below `least`."""
    def at(k):
        tried.append(k)
        return Problem(SymplecticMap([(1, 0)], [F(round(1000 * k), 1000)]))

    tried = []
    golden = read_rotation("golden")
    proof, k = vectors.highest(at, golden, 1.1, 1 << 12)
    assert 0.8 < k < 0.9716 and k == tried[-1] == min(tried) and tried[0] == 1.1
    assert proof.torus.potential.amplitude == (F(round(1000 * k), 1000),)
    tried.clear()
    assert vectors.highest(at, golden, 1.1, 1 << 12, least=1.0) == (None, 1.0)
    assert tried == [1.1]


def test_where_one_angle_is_alone_the_golden_circle_is_proved(tmp_path):
    found = ParameterMap.new("c=0", F(21, 20))
    found.estimate[:] = [{F(0): 0.3, F(1): 0.03}]
    rays.prove_tori(found, tmp_path, rays.named, 1 << 15)
    points = dict(proved_points(tmp_path))
    assert points[F("0.3"), 0, 0] == "golden" and points[F("0.03"), F("0.03"), 0] in ("T49", "V1")


@pytest.mark.slow
def test_a_torus_of_another_kind_is_refused(few, tmp_path):
    path = next(few[1].iterdir())
    (tmp_path / "x.torus").write_bytes(path.read_bytes()[:200])
    with pytest.raises(ConverseError, match="x.torus"):
        proved_points(tmp_path)
    with pytest.raises(ConverseError, match="name the directory"):
        proved_points(tmp_path / "nowhere")


@pytest.mark.slow
def test_the_command_draws_them(few, tmp_path, capsys):
    found, directory = few
    for face, (_, far) in enumerate(found.directions):
        for s in found.places():
            found.estimate[face].setdefault(s, 0.1)
    path, picture = tmp_path / "ab.json", tmp_path / "ab.svg"
    found.save(path)
    assert cli.main(["--tori", str(directory), "-g", str(picture), str(path)]) == 1
    assert "\nTori : 3 of the plane, with certificates in %s that converse-check verifies\n" \
        % directory in capsys.readouterr().out
    assert "a torus is proved" in picture.read_text()


@pytest.mark.slow
def test_tori_of_another_plane_are_left_out(few, tmp_path, capsys):
    """The tori lie in a = b: one has c = 0 as well, one b = 0, and the third has neither."""
    path, picture = tmp_path / "c.json", tmp_path / "c.svg"
    for region, count in (("c=0", 1), ("b=0", 1), ("a=b", 3)):
        found = ParameterMap.new(region, F(21, 20))
        found.save(path)
        assert cli.main(["--tori", str(few[1]), str(path)]) == 1
        assert "\nTori : %d of" % count in capsys.readouterr().out
    found = ParameterMap.new("c=0", F(21, 20))
    found.estimate[0].update(dict.fromkeys(found.places(), 0.1))
    for points, drawn in (([(F(1), F(1), F(1))], False), ([(F(1), F(1), F(0))], True)):
        map_figure.draw(found, picture, points)
        assert ("a torus is proved" in picture.read_text()) == drawn
