"""Which files are written: none that is something else, and each whole or not at all."""

import os

import pytest

from converse.storage import files
from converse.storage.files import ConverseError, check_output, check_writable

FIGURES = "svg", "png", "pdf"


@pytest.fixture
def place(tmp_path, monkeypatch):
    """A folder with a folder a.pdf, a file, and a link to a figure."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "a.pdf").mkdir()
    (tmp_path / "plain").touch()
    (tmp_path / "copy.svg").write_text("mine")
    (tmp_path / "link.svg").symlink_to("copy.svg")
    return tmp_path


@pytest.mark.parametrize("path", ["a.pdf", "missing/a.pdf", "plain/a.pdf", "/proc/a.pdf", ""])
def test_what_cannot_be_written_is_refused_before_the_work(place, path):
    with pytest.raises(ConverseError, match="^(?s:(?!\n).)*%s" % path):
        check_writable(path)


@pytest.mark.parametrize("path, others, words", [
    *((name, [], "ends in .svg or .png or .pdf") for name in (
        "a", "a.json", "a.svg.txt", "a.csv", "a.npz", "a.proof.gz")),
    *((name, ["copy.svg"], "would overwrite it") for name in (
        "copy.svg", "./copy.svg", "link.svg")),
    ("b.svg", [None, "./b.svg"], "would overwrite it"), ("copy.svg", [None], "exists")])
def test_a_figure_overwrites_nothing(place, path, others, words):
    before = {each: each.read_bytes() for each in place.iterdir() if each.is_file()}
    with pytest.raises(ConverseError, match=words):
        check_output(path, "figure", FIGURES, others)
    assert {each: each.read_bytes() for each in place.iterdir() if each.is_file()} == before


def test_a_figure_replaces_its_like(place):
    """What another program made has the same first bytes."""
    for ending, (head, mark) in files.MADE.items():
        path = place / ("made." + ending)
        for data, ours in (b"", True), (head + mark, True), (head, False), (b"x" + mark, False):
            path.write_bytes(data)
            if ours:
                check_output(path, "figure", (ending,))
            else:
                with pytest.raises(ConverseError, match="not a figure of this program"):
                    check_output(path, "figure", (ending,))


def test_a_lock_of_another_run_is_left_alone(tmp_path):
    path = str(tmp_path / "a")
    with files.Lock(path):
        os.unlink(path + ".lock")
        open(path + ".lock", "w").close()       # as if another run had come
    assert os.path.exists(path + ".lock")


def test_a_file_is_on_the_disk_before_it_replaces_another(tmp_path, monkeypatch):
    """Else a power failure after the renaming could leave neither the old text nor the new one."""
    done, real = [], {name: getattr(os, name) for name in ("fsync", "replace")}
    for name in real:
        def call(*arguments, name=name):
            done.append(name)
            return real[name](*arguments)
        monkeypatch.setattr(os, name, call)
    files.write(tmp_path / "a", b"x")
    assert done == ["fsync", "replace"]


@pytest.mark.parametrize("mask, mode", [(0o077, 0o600), (0o022, 0o644)])
def test_permissions_of_a_new_file(tmp_path, mask, mode):
    before = os.umask(mask)
    try:
        files.write(tmp_path / "new", b"")
    finally:
        os.umask(before)
    assert (tmp_path / "new").stat().st_mode & 0o777 == mode
    (tmp_path / "new").chmod(0o640)
    files.write(tmp_path / "new", b"x")
    assert (tmp_path / "new").stat().st_mode & 0o777 == 0o640
