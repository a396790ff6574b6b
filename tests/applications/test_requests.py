"""One request a verb: Python and the command line fill the same, and it is checked there."""

from __future__ import annotations

import inspect
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import rectbench as rb
from rectbench.applications.requests.photographs import PoseSettings, RectifyRequest, UncertaintyRequest
from rectbench.applications.requests.rendering import ExportRequest, RenderRequest
from rectbench.applications.requests.request import Request
from rectbench.applications.requests.running import PlanRequest, RunRequest

NOT_IN_THE_REQUEST = {"progress", "images", "framing"}
PUBLIC = [
    (rb.rectify_images, RectifyRequest),
    (rb.render, RenderRequest),
    (rb.export_dataset, ExportRequest),
    (rb.run, RunRequest),
    (rb.plan, PlanRequest),
]


@pytest.mark.parametrize(("call", "request_type"), PUBLIC)
def test_the_defaults_of_python_are_those_of_the_request(
    call: Callable[..., Any], request_type: type[Request]
) -> None:
    parameters = inspect.signature(call).parameters
    for name in parameters.keys() - NOT_IN_THE_REQUEST:
        field, default = request_type.model_fields[name], parameters[name].default
        if default not in (inspect.Parameter.empty, None) and not field.is_required():
            same = list(default) == list(field.default) if isinstance(default, tuple) else None
            assert same or str(default) == str(field.default), name


@pytest.mark.parametrize(
    "request_type", [RectifyRequest, RenderRequest, ExportRequest, RunRequest, PlanRequest]
)
def test_every_field_is_described(request_type: type[Request]) -> None:
    for name, field in request_type.model_fields.items():
        assert field.description, name


@pytest.mark.parametrize(
    ("request_type", "given", "message"),
    [
        (PoseSettings, {"seed": -1}, "seed is -1; expected a whole number from 0 on"),
        (PoseSettings, {"seed": True}, "seed is True; expected a whole number from 0 on"),
        (PoseSettings, {"ratio": 0}, "ratio is 0; expected a number above 0"),
        (PoseSettings, {"farthest": float("inf")}, "farthest is inf; expected a number above 0"),
        (RunRequest, {"report": "quick", "jobs": 0}, "jobs is 0; expected a whole number from 1 on"),
        (RunRequest, {"report": "quick", "methods": "abraham"}, "methods is 'abraham'; expected a list"),
        (
            RenderRequest,
            {"scene": "a", "rig": "b", "image_width": 1.5},
            "image_width is 1.5; expected a width",
        ),
        (ExportRequest, {"scene": "a", "rig": "b", "seeds": [0, 0.5]}, "0.5; expected a whole number from 0"),
        (UncertaintyRequest, {"rig": "t265", "matching_px": -1}, "matching_px is -1; expected greater than"),
        (RectifyRequest, {"left": "a", "right": "b", "size": "9"}, "size is 9; expected width and height"),
        (RectifyRequest, {"left": "a", "right": "b", "crop": "1,2"}, "crop is 1,2; expected valid, or"),
    ],
)
def test_what_cannot_be_used_is_refused_in_one_line(
    request_type: type[Request], given: dict[str, Any], message: str
) -> None:
    with pytest.raises(rb.InvalidInput) as caught:
        request_type(**given)
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)


def test_numbers_of_numpy_are_numbers() -> None:
    assert PoseSettings(seed=np.int64(3), ratio=np.float32(0.5)).model_dump()["seed"] == 3
    assert ExportRequest(scene="a", rig="b", seeds=np.arange(3)).seeds == [0, 1, 2]
    size = RectifyRequest(left="a", right="b", size=(np.int64(4), np.int64(3))).size
    assert size == (4, 3)
