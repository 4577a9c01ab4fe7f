"""What calculations take."""

from converse.tori.effort import free_memory


def test_free_memory_is_that_of_the_container(tmp_path):
    """The least of what the machine and the container have, of version 1 or 2; what files occupy in
    memory is free."""
    def write(path, text):
        path = tmp_path / path
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text)

    assert free_memory(tmp_path) == 4 << 30
    write("proc/meminfo", "MemTotal:  9000000 kB\nMemAvailable:  8000000 kB\n")
    assert free_memory(tmp_path) == 8000000 * 1024
    write("sys/fs/cgroup/memory.max", "%d\n" % (3 << 30))
    write("sys/fs/cgroup/memory.current", "%d\n" % (2 << 30))
    write("sys/fs/cgroup/memory.stat", "anon 5\ninactive_file 1000\n")
    assert free_memory(tmp_path) == (1 << 30) + 1000
    write("sys/fs/cgroup/memory.max", "max\n")
    assert free_memory(tmp_path) == 8000000 * 1024
    write("sys/fs/cgroup/memory/memory.limit_in_bytes", "%d\n" % (2 << 30))
    write("sys/fs/cgroup/memory/memory.usage_in_bytes", "%d\n" % (3 << 30))
    assert free_memory(tmp_path) == 0
    assert 0 < free_memory() < 1 << 50
