from __future__ import annotations

import errno
import logging
import os
import time
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from rectbench.errors import Unavailable
from rectbench.store.store import MANIFEST, Store

INPUTS = {"scene": "street", "seed": 0}


def put(store: Store, inputs: dict[str, object] | None = None, text: str = "content") -> Path:
    return store.write("things", inputs or INPUTS, lambda folder: _fill(folder, text))


def _fill(folder: Path, text: str) -> None:
    (folder / "a.txt").write_text(text)
    (folder / "b.txt").write_text(text * 2)


def unfinished(store: Store) -> list[Path]:
    return list(store.root.glob("*/??/.unfinished-*"))


def test_what_is_written_is_read(store: Store) -> None:
    assert store.read("things", INPUTS) is None
    assert not store.has("things", INPUTS)
    put(store)
    folder = store.read("things", INPUTS)
    assert folder is not None
    assert (folder / "a.txt").read_text() == "content"
    assert store.has("things", INPUTS)
    assert store.read("things", {**INPUTS, "seed": 1}) is None
    assert store.read("others", INPUTS) is None


@pytest.mark.parametrize("name", ["a.txt", "b.txt", MANIFEST])
@pytest.mark.parametrize("damage", ["changed", "cut short", "empty", "removed"])
def test_a_damaged_object_is_dropped_with_a_word(
    store: Store, name: str, damage: str, caplog: pytest.LogCaptureFixture
) -> None:
    file = put(store) / name
    content = file.read_bytes()
    if damage == "removed":
        file.unlink()
    else:
        left = {"changed": b"\x00" + content[1:], "cut short": content[: len(content) // 2], "empty": b""}
        file.write_bytes(left[damage])
    with caplog.at_level(logging.WARNING, logger="rectbench.store"):
        assert store.read("things", INPUTS) is None
    assert "damaged" in caplog.text
    assert name in caplog.text
    put(store, text="again")
    folder = store.read("things", INPUTS)
    assert folder is not None
    assert (folder / "a.txt").read_text() == "again"


def test_a_writer_that_fails_leaves_nothing(store: Store) -> None:
    def fail(folder: Path) -> None:
        (folder / "a.txt").write_text("half")
        raise RuntimeError("no more")

    with pytest.raises(RuntimeError):
        store.write("things", INPUTS, fail)
    assert store.read("things", INPUTS) is None
    assert unfinished(store) == []


def test_a_full_disk_is_said_in_one_line(store: Store) -> None:
    def fail(folder: Path) -> None:
        raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    with pytest.raises(Unavailable, match="cannot be written: No space left on device"):
        store.write("things", INPUTS, fail)
    assert unfinished(store) == []


def test_writers_of_one_object_do_not_disturb_each_other(store: Store) -> None:
    with ThreadPoolExecutor(8) as threads:
        places = set(threads.map(lambda _: put(store), range(24)))
    assert len(places) == 1
    assert store.read("things", INPUTS) in places
    assert unfinished(store) == []


def test_one_process_at_a_time_makes_an_object(store: Store) -> None:
    made = []

    def make(_: int) -> None:
        with store.making("things", INPUTS):
            if store.read("things", INPUTS) is None:
                made.append(1)
                time.sleep(0.05)
                put(store)

    with ThreadPoolExecutor(4) as threads:
        list(threads.map(make, range(4)))
    assert made == [1]


def test_collect_removes_what_is_old_and_then_what_is_too_much(store: Store) -> None:
    places = [put(store, {"n": n}) for n in range(4)]
    now = time.time()
    for n, place in enumerate(places):
        os.utime(place / MANIFEST, (now, now - (4 - n) * 86400))
    assert [entry.path for entry in store.entries()] == places
    assert [entry.path for entry in store.collect(max_age_days=3.5)] == places[:1]
    size = store.entries()[0].size_bytes
    assert [entry.path for entry in store.collect(max_bytes=2 * size)] == places[1:2]
    assert [entry.path for entry in store.entries()] == places[2:]
    assert store.collect() == []


def test_reading_makes_an_object_young(store: Store) -> None:
    place = put(store)
    os.utime(place / MANIFEST, (0, 0))
    store.read("things", INPUTS)
    assert store.collect(max_age_days=1) == []


def test_collect_removes_what_killed_writers_left(store: Store) -> None:
    left = put(store).parent / ".unfinished-x"
    left.mkdir()
    store.collect()
    assert left.exists()  # perhaps another process is at it
    os.utime(left, (0, 0))
    store.collect()
    assert not left.exists()
