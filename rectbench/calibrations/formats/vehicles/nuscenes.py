"""nuScenes' `calibrated_sensor.json`, with `sensor.json` beside it for the channels' names.

A record has a camera's `camera_intrinsic`, K, and its pose in the vehicle: `rotation` (w, x, y, z) and
`translation`, metres, take the camera's points there (nuScenes' schema). The images are rectified, 1600x900
pixels, pixel (0, 0) the centre of one. Cameras go by their channels, such as CAM_FRONT, or where a channel
has several records, of several logs, by these' tokens.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rectbench.calibrations.assembling import camera_of, rigid
from rectbench.calibrations.contract import Given, PosedCamera, RigFormat
from rectbench.calibrations.documents import Section, Source
from rectbench.calibrations.formats.named_cameras import by_name, quaternion_rotation, rig_of_named
from rectbench.calibrations.formats.toolboxes.opencv import camera_matrix
from rectbench.errors import InvalidInput
from rectbench.rigs.rig import Rig

SIZE = (1600, 900)
"""Width and height of every image of nuScenes, pixels."""

INTRINSIC = "camera_intrinsic"
SENSORS = "sensor.json"
MARKS = {"sensor_token", "rotation", "translation", INTRINSIC}


def _read(sources: Sequence[Source], given: Given) -> Rig:
    source = next(source for source in sources if _recognises(source))
    channels = _channels(source, [other for other in sources if other is not source])
    records = [record for record in source.records if record.values.get(INTRINSIC)]
    names = [_name(record, channels) for record in records]
    count = Counter(names)
    tokens = [
        name if count[name] == 1 else record.text("token", "the record's token")
        for name, record in zip(names, records, strict=True)
    ]
    cameras = by_name(zip(tokens, records, strict=True))
    return rig_of_named(source, cameras, lambda record: _read_posed(record, given), given, unit="m")


def _channels(source: Source, others: list[Source]) -> dict[str, str]:
    """The channels by the sensors' tokens; none where there is no file of them."""
    if not others:
        try:
            others = [source.beside(SENSORS)]
        except InvalidInput:
            return {}
    records = [record for other in others for record in other.records if "channel" in record]
    return {record.text("token", "a token"): record.text("channel", "a name") for record in records}


def _name(record: Section, channels: dict[str, str]) -> str:
    token = record.text("sensor_token", "the sensor's token")
    return channels.get(token, token)


def _read_posed(record: Section, given: Given) -> PosedCamera:
    camera = camera_of(
        record.where, "pinhole", given.size or SIZE, camera_matrix(record, INTRINSIC, "pinhole")
    )
    wxyz = record.numbers("rotation", "w, x, y, z", 4)
    T = rigid(
        quaternion_rotation(record.at("rotation"), wxyz), record.numbers("translation", "three metres", 3)
    )
    return PosedCamera(record.where, camera, T)


def _recognises(source: Source) -> bool:
    return bool(source.records) and source.records[0].values.keys() >= MARKS


FORMAT = RigFormat("nuscenes", "nuScenes calibrated_sensor (JSON)", _recognises, _read, has_many=True)
