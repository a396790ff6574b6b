"""The verbs that render: a pair, and a dataset for other tools."""

from __future__ import annotations

from rectbench.applications.requests.rendering import ExportRequest, RenderRequest
from rectbench.cli.app import GOOD, verb


@verb(RenderRequest)
def render(request: RenderRequest) -> int:
    """Render a rig in a scene: left.png, right.png, truth.npz, truth EXRs and rig.yaml."""
    from rectbench.applications.render import render, save_rendered
    from rectbench.writing import check_writable

    check_writable(request.out)
    save_rendered(*render(request), request.out)
    print(request.out)
    return GOOD


@verb(ExportRequest)
def export(request: ExportRequest) -> int:
    """Render a dataset: images, depth, flow, rectified pairs with disparity, masks and calibrations.

    README.md in the folder says what each file is and how it is read. An export that was cut off goes on
    where it was; one with more seeds adds pairs.
    """
    from rectbench.applications.export.dataset import export_dataset

    made = export_dataset(request)
    print(f"{made.folder}: {len(made.rendered)} pairs rendered, {len(made.kept)} there already")
    return GOOD
