"""ROS 2 bags, as the library rosbags writes them."""

import sqlite3
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from machine_logs import JOINTS, PERIOD, positions, times
from rosbags.rosbag2 import StoragePlugin, Writer
from rosbags.typesys import Stores, get_typestore

from cutpoint.errors import InputError
from cutpoint.identification import read_recording, read_table
from cutpoint.identification.logs import bag_storage, read_bag

STORE = get_typestore(Stores.ROS2_JAZZY)
STATE, ARRAY = "sensor_msgs/msg/JointState", "std_msgs/msg/Float64MultiArray"
START = 1_700_000_000 * 10**9
T = times(60)
Q, V = positions(T), positions(T, 1)
STORAGES = {"db3": StoragePlugin.SQLITE3, "mcap": StoragePlugin.MCAP}


def state(stamp: int, names: tuple[str, ...], position: Any, velocity: Any = ()) -> Any:
    header = STORE.types["std_msgs/msg/Header"]
    time = STORE.types["builtin_interfaces/msg/Time"](sec=stamp // 10**9, nanosec=stamp % 10**9)
    numbers = [np.array(each, dtype=np.float64) for each in (position, velocity, [])]
    return STORE.types[STATE](header(stamp=time, frame_id=""), list(names), *numbers)


def array(numbers: Any) -> Any:
    layout = STORE.types["std_msgs/msg/MultiArrayLayout"](dim=[], data_offset=0)
    return STORE.types[ARRAY](layout=layout, data=np.array(numbers, dtype=np.float64))


def written(folder: Path, kind: str, messages: list[tuple[str, str, int, Any]]) -> Path:
    """The one file of a bag with messages (topic, type, received, content), taken out of its folder."""
    with Writer(folder / "bag", version=9, storage_plugin=STORAGES[kind]) as writer:
        types = {topic: type for topic, type, _, _ in messages}
        topics = {topic: writer.add_connection(topic, type, typestore=STORE) for topic, type in types.items()}
        for topic, type, received, content in messages:
            writer.write(topics[topic], received, STORE.serialize_cdr(content, type))
    (found,) = (folder / "bag").glob(f"*.{kind}")
    return found.rename(folder / f"log.{kind}")


def arm(late: int = 0) -> list[tuple[str, str, int, Any]]:
    stamps = [START + round(1e9 * t) for t in T]
    return [
        ("/joint_states", STATE, stamp + late, state(stamp, JOINTS, q, v))
        for stamp, q, v in zip(stamps, Q, V, strict=True)
    ]


@pytest.mark.parametrize("kind", STORAGES)
def test_joint_states_are_read_at_the_time_of_their_headers(tmp_path: Path, kind: str):
    found = read_recording(written(tmp_path, kind, arm(late=12_345_678)))
    assert found.joints == JOINTS
    assert np.allclose(found.time, T, rtol=0.0, atol=1e-9)
    assert np.array_equal(found["q"], Q)
    assert np.array_equal(found["v"], V)
    assert set(found.channels) == {"q", "v"}


@pytest.mark.parametrize("kind", STORAGES)
def test_a_folder_is_read_file_by_file_without_its_metadata(tmp_path: Path, kind: str):
    messages = arm()
    for name, part in (("a", messages[:30]), ("b", messages[30:])):
        (tmp_path / name).mkdir()
        written(tmp_path / name, kind, part).rename(tmp_path / f"{name}.{kind}")
    (tmp_path / "metadata.yaml").write_text("!!python/object/apply:os.abort []")
    assert np.array_equal(read_recording(tmp_path)["q"], Q)


def test_plain_arrays_are_read_beside_and_brought_to_the_times_of_the_joints(tmp_path: Path):
    command = [
        ("/command", ARRAY, START + round(1e9 * (t + 0.5 * PERIOD)), array(q))
        for t, q in zip(T, positions(T + 0.5 * PERIOD), strict=True)
    ]
    mapping = {"version": 1, "q": "/joint_states.position", "torque": "/command.data"}
    found = read_recording(written(tmp_path, "mcap", [*arm(), *command]), mapping)
    inside = slice(1, None)
    # a spline of step h is off by a few h^4 of the fourth derivative, 2.2e-6 h^4 ... below 1e-8 here
    assert np.allclose(found["torque"][inside], Q[inside], rtol=0.0, atol=1e-7)
    assert np.isnan(found["torque"][0]).all()
    assert "torque: brought from its own times to those of the first channel" in " ".join(found.notes)


def test_messages_that_name_the_joints_in_another_order_are_one_series(tmp_path: Path):
    messages = arm()
    stamp = messages[7][2]
    messages[7] = ("/joint_states", STATE, stamp, state(stamp, JOINTS[::-1], Q[7][::-1], V[7][::-1]))
    assert np.array_equal(read_recording(written(tmp_path, "db3", messages))["q"], Q)


def test_a_gripper_on_the_same_topic_is_a_series_of_its_own(tmp_path: Path):
    messages = arm()
    gripper = [("/joint_states", STATE, at, state(at, ("finger",), [0.1])) for _, _, at, _ in messages]
    mixed = [each for pair in zip(messages, gripper, strict=True) for each in pair]
    table = read_table(written(tmp_path, "db3", mixed))
    assert np.array_equal(table.channels["/joint_states.position"].values, Q)
    assert table.channels["/joint_states#2.position"].labels == ("finger",)


def test_messages_without_a_stamp_have_the_time_of_their_arrival(tmp_path: Path):
    messages = [(topic, type, at, state(0, JOINTS, q)) for (topic, type, at, _), q in zip(arm(), Q, strict=True)]
    assert np.allclose(read_recording(written(tmp_path, "mcap", messages)).time, T, rtol=0.0, atol=1e-9)


@pytest.mark.parametrize("packing", ["lz4", "zstd"])
def test_packed_chunks_are_unpacked_and_never_to_more_than_they_announce(tmp_path: Path, packing: str):
    import lz4.frame
    from backports import zstd

    pack = {"lz4": lz4.frame.compress, "zstd": zstd.compress}[packing]
    path = written(tmp_path, "mcap", arm())
    plain = [(each.topic, each.data) for each in bag_storage.stored_messages(path)]
    for announced in (0, -1):
        packed = tmp_path / f"packed{announced}.mcap"
        packed.write_bytes(repacked(path.read_bytes(), packing, pack, announced))
        if announced:
            with pytest.raises(InputError, match=r"a chunk does not unpack to its stated .* bytes"):
                read_table(packed)
        else:
            assert [(each.topic, each.data) for each in bag_storage.stored_messages(packed)] == plain


def repacked(content: bytes, packing: str, pack: Any, more: int) -> bytes:
    """An MCAP with its chunks packed, and announced to be some bytes larger."""
    start, place, name = content[:8], 8, packing.encode()
    while True:
        kind, size = content[place], int.from_bytes(content[place + 1 : place + 9], "little")
        record = content[place + 9 : place + 9 + size]
        if kind == bag_storage.CHUNK:
            records = pack(record[40:])  # behind four numbers, an empty text and their length
            large = int.from_bytes(record[16:24], "little") + more
            record = record[:16] + large.to_bytes(8, "little") + bytes(4) + len(name).to_bytes(4, "little") + name
            record += len(records).to_bytes(8, "little") + records
        start += bytes([kind]) + len(record).to_bytes(8, "little") + record
        if kind == bag_storage.DATA_END:
            return start
        place += 9 + size


@pytest.mark.parametrize("kind", STORAGES)
def test_a_bag_cut_off_or_changed_anywhere_is_refused_or_read(tmp_path: Path, kind: str):
    content = written(tmp_path, kind, arm()[:8]).read_bytes()
    rng = np.random.default_rng(5)
    for k in range(60):
        changed = bytearray(content[: len(content) if k % 2 else int(rng.integers(len(content)))])
        for place in rng.integers(len(changed), size=3 * (k % 2)):
            changed[place] = int(rng.integers(256))
        path = tmp_path / f"changed.{kind}"
        path.write_bytes(changed)
        try:
            assert read_table(path).channels
        except InputError as error:
            assert error.place


def test_a_bag_whose_messages_are_a_program_is_refused(tmp_path: Path):
    with sqlite3.connect(tmp_path / "log.db3") as base:
        base.execute("CREATE TABLE topics (id INTEGER, name TEXT, type TEXT)")
        endless = "WITH RECURSIVE c(x) AS (SELECT 1 UNION ALL SELECT x + 1 FROM c) SELECT x FROM c"
        base.execute(f"CREATE VIEW messages AS {endless}")
    base.close()
    with pytest.raises(InputError, match=r"it has no tables 'topics' and 'messages'"):
        read_table(tmp_path / "log.db3")


def test_a_bag_whose_messages_are_computed_or_too_many_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = written(tmp_path, "db3", arm())
    with sqlite3.connect(path) as base:
        # a hundred topics of one number: every message counts a hundred times
        base.execute("ALTER TABLE topics RENAME TO once")
        base.execute("CREATE TABLE topics AS SELECT * FROM once")
        base.executemany("INSERT INTO topics SELECT * FROM once WHERE ?", [(True,)] * 99)
    base.close()
    monkeypatch.setattr(bag_storage, "LARGEST_FILE", 10 * path.stat().st_size)
    with pytest.raises(InputError, match=r"its messages exceed [\d,]+ bytes"):
        read_table(path)
    with sqlite3.connect(path) as base:
        base.execute("ALTER TABLE messages ADD COLUMN more BLOB GENERATED ALWAYS AS (zeroblob(900000000))")
    base.close()
    with pytest.raises(InputError, match=r"its tables 'topics' and 'messages' have computed columns"):
        read_table(path)


def test_a_bag_or_a_folder_without_such_messages_is_refused(tmp_path: Path):
    text = STORE.types["std_msgs/msg/String"](data="a text")
    path = written(tmp_path, "mcap", [("/chatter", "std_msgs/msg/String", START, text)])
    with pytest.raises(InputError, match=r"bag holds no sensor_msgs/msg/JointState and no std_msgs/msg/Float64Multi"):
        read_table(path)
    (tmp_path / "empty").mkdir()
    with pytest.raises(InputError, match=r"folder holds no .db3 and no .mcap"):
        read_table(tmp_path / "empty")


def test_empty_messages_of_an_mcap_count_too(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    path = written(tmp_path, "mcap", [("/command", ARRAY, START + k, array([])) for k in range(1000)])
    monkeypatch.setattr(bag_storage, "MESSAGE_ITSELF", 10**6)
    with pytest.raises(InputError, match=r"its unpacked messages exceed 1,000,000,000 bytes"):
        read_table(path)


@pytest.mark.parametrize("kind", STORAGES)
def test_endings_may_be_in_capitals(tmp_path: Path, kind: str):
    path = written(tmp_path, kind, arm())
    path = path.rename(path.with_suffix(f".{kind.upper()}"))
    assert np.array_equal(read_recording(path)["q"], Q)
    (tmp_path / "folder").mkdir()
    path.rename(tmp_path / "folder" / path.name)
    assert np.array_equal(read_recording(tmp_path / "folder")["q"], Q)


def test_a_folder_of_more_files_than_are_read_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    for name in "ab":
        (tmp_path / f"{name}.mcap").touch()
    monkeypatch.setattr(read_bag, "MOST_FILES", 1)
    with pytest.raises(InputError, match=r"folder holds 2 bag files: at most 1 are read"):
        read_table(tmp_path)
