"""The command line: what it prints, and how it ends."""

from __future__ import annotations

import re
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import cv2
import numpy as np
import pandas as pd
import pytest

import rectbench as rb
from rectbench import cli
from rectbench.plugins.rectifier import METHODS
from rectbench.registry import forget_plugins, registry
from rectbench.store.store import STORE_VARIABLE
from tests.conftest import Shell
from tests.experiments.fakes import write_method, write_report_file, write_scene


@pytest.fixture(autouse=True)
def _place(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[None]:
    monkeypatch.setenv(STORE_VARIABLE, str(tmp_path / "store"))
    monkeypatch.chdir(tmp_path)
    yield
    forget_plugins()


@pytest.fixture(scope="module")
def finished(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a small report file and a run of it, rendered, with its page."""
    folder = tmp_path_factory.mktemp("finished")
    wall = write_scene(folder, "wall")
    report = write_report_file(
        folder,
        scenes=(wall,),
        motions=("sideways",),
        poses=("exact", "perturbed"),
        methods=("abraham", "conventional"),
        metrics=("geometry", "row_error", "timing"),
        figures=("bars", "pairs"),
    )
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv(STORE_VARIABLE, str(folder / "store"))
        patch.setattr(sys, "argv", ["rectbench", "run", report, "--out", str(folder / "run"), "--jobs", "2"])
        with pytest.raises(SystemExit) as ended:
            cli.main()
    assert ended.value.code == 0
    return folder


def test_a_run_leaves_the_folder_of_the_contract(finished: Path) -> None:
    run = finished / "run"
    for name in ("run.json", "results.parquet", "results.csv", "index.html"):
        assert (run / name).is_file()
    for folder, endings in (("tables", {".csv", ".md", ".tex"}), ("figures", {".pdf", ".svg", ".png"})):
        assert endings <= {file.suffix for file in (run / folder).iterdir()}
    table = pd.read_parquet(run / "results.parquet")
    assert (table["status"] == "ok").all()
    assert (table[table["pose"] == "exact"]["row_error_max_px"] < 1e-6).all()
    assert (table[table["pose"] == "perturbed"]["row_error_mean_px"] > 1e-3).all()


def test_a_run_ends_by_printing_the_table_and_the_page(
    shell: Shell, finished: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv(STORE_VARIABLE, str(finished / "store"))
    before = (finished / "run" / "results.parquet").read_bytes()
    code, out, err = shell("run", finished / "small.py", "--out", finished / "run")
    assert code == 0
    assert err == ""
    assert "abraham" in out
    assert "conventional" in out
    assert str(finished / "run" / "index.html") in out
    assert (finished / "run" / "results.parquet").read_bytes() == before


def test_python_gives_the_rows_of_the_file(finished: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(STORE_VARIABLE, str(finished / "store"))
    table = rb.run(finished / "small.py", out=finished / "again", jobs=1)
    pd.testing.assert_frame_equal(table, pd.read_parquet(finished / "run" / "results.parquet"))
    assert (finished / "again" / "index.html").exists()


def test_report_writes_the_page_again(shell: Shell, finished: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv(STORE_VARIABLE, str(finished / "store"))
    page = (finished / "run" / "index.html").read_bytes()
    (finished / "run" / "index.html").unlink()
    assert shell("report", finished / "run")[0] == 0
    assert (finished / "run" / "index.html").read_bytes() == page


def test_gate_answers_with_its_exit_code(shell: Shell, finished: Path) -> None:
    run, accepted = finished / "run", finished / "small.accepted.csv"
    code, _, err = shell("gate", run)
    assert code == 2
    assert "--accept" in err
    code, out, _ = shell("gate", run, "--accept")
    assert code == 0
    assert str(accepted) in out
    assert shell("gate", run)[:1] == (0,)
    text = accepted.read_text()
    table = pd.read_csv(accepted)
    table["log_distortion"] *= 0.9
    table.to_csv(accepted, index=False)
    code, out, _ = shell("gate", run)
    assert code == 1
    assert out.count("regression: ") == 4
    accepted.write_text(text.splitlines()[0] + "\n")
    assert shell("gate", run)[0] == 3
    accepted.unlink()


def test_compare_says_what_changed(shell: Shell, finished: Path) -> None:
    code, out, _ = shell("compare", finished / "run", finished / "run", "--metrics", "log_distortion")
    assert code == 0
    assert len(re.findall(r"(abraham|conventional) +log distortion", out)) == 4  # under two poses
    code, _, err = shell("compare", finished / "run", finished / "run", "--metrics", "log_distorsion")
    assert code == 2
    assert "did you mean log_distortion" in err


@pytest.mark.parametrize(
    ("words", "message"),
    [
        ("run quik", "unknown report 'quik'; did you mean quick"),
        ("run quick --methods abrahm", "unknown method 'abrahm'; did you mean abraham"),
        ("run quick --scenes strete", "unknown scene 'strete'; did you mean street"),
        ("run quick --rigs t256", "unknown rig 't256'; did you mean t265"),
        ("run quick --seeds one", "--seeds is one; expected whole numbers"),
        ("run quick --jobs 0", "jobs is 0"),
        ("run quick --jobs two", "--jobs"),
        ("run quick --option abraham", "expected method.name=value"),
        ("run quick --option abraham.lew=1", "unknown option of abraham 'lew'; did you mean law"),
        ("run quick --option abraham.focal_px=-3", "abraham: option focal_px is -3; expected greater than 0"),
        ("run quick --config absent.toml", "absent.toml cannot be read"),
        ("run absent.py", "there is no file absent.py"),
        ("run quick --methods absent.py", "there is no file absent.py"),
        ("run quick --rigs absent.yaml", "absent.yaml"),
        ("run quick --dask tcp://127.0.0.1:9 --frsh", "--frsh"),
        ("run", "REPORT"),
        ("rnu quick", "rnu"),
        ("list methds", "unknown kind 'methds'; did you mean methods"),
        ("report absent", "is no run's folder"),
        ("gate absent", "is no run's folder"),
        ("compare absent absent", "is no run's folder"),
        ("check abrahm", "unknown method 'abrahm'"),
        ("render strete t265 -o out", "unknown scene 'strete'"),
        ("render street t256 -o out", "unknown rig 't256'"),
        ("render street t265 -o out --motion sidewards", "unknown motion 'sidewards'"),
        ("render street t265 -o out --quality best", "unknown quality 'best'"),
        ("render street t265 -o out --spp 3", "spp is 3"),
        ("render street t265 -o out --width 0", "--width is 0"),
        ("rectify a.png b.png --rig t265 -o out", "a.png"),
        ("gc --older-than -1", "--older-than"),
    ],
)
def test_wrong_usage_is_one_line_and_code_2_and_writes_nothing(
    shell: Shell, tmp_path: Path, words: str, message: str
) -> None:
    code, out, err = shell(*words.split())
    assert code == 2
    assert message in err
    assert err.startswith("rectbench: ")
    assert err.count("\n") == 1
    assert out == ""
    assert not (tmp_path / "out").exists()
    assert not (tmp_path / "runs").exists()


def test_list_shows_everything_and_what_is_broken(
    shell: Shell, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    code, out, _ = shell("list")
    assert code == 0
    for name in ("local-homography", "street", "t265", "sideways", "perturbed", "quick"):
        assert name in out
    forget_plugins()
    found = registry(METHODS)
    found.broken["/there/mine.py"] = "SyntaxError: no"
    code, out, _ = shell("list", "methods")
    assert code == 0
    assert "broken: /there/mine.py: SyntaxError: no" in out


def test_verbose_list_shows_options(shell: Shell) -> None:
    _, out, _ = shell("list", "methods", "-v")
    assert "--option abraham.law" in out
    assert "equidistant | stereographic" in out


def test_check_passes_a_sound_method_and_fails_a_faulty_one(shell: Shell, tmp_path: Path) -> None:
    code, out, _ = shell("check", write_method(tmp_path, "sound"))
    assert code == 0
    assert "all checks passed" in out
    code, out, _ = shell("check", write_method(tmp_path, "faulty", "raise ValueError('no')"))
    assert code == 1
    assert "ValueError: no" in out


def test_doctor_finds_nothing_missing_here(shell: Shell) -> None:
    code, out, _ = shell("doctor")
    assert code == 0, out
    for word in ("Python", "LLVM", "mitsuba", "store", "local-homography"):
        assert word in out


def test_gc_tells_and_empties_the_store(shell: Shell, tmp_path: Path) -> None:
    report = write_report_file(tmp_path)
    assert shell("run", report, "--jobs", "1")[0] == 0
    kept = 1 + len(list(Path("runs/small/figures").glob("*.svg")))  # a cell, and each figure
    assert f"{kept} objects" in shell("gc")[1]
    assert f"removed {kept} objects" in shell("gc", "--older-than", "0")[1]
    assert "0 objects" in shell("gc")[1]


def test_a_config_file_and_the_command_line_say_the_same(shell: Shell, tmp_path: Path) -> None:
    report = write_report_file(tmp_path)
    (tmp_path / "run.toml").write_text(
        '[run]\nout = "there"\nmethods = ["conventional"]\njobs = 1\n[methods.conventional]\nfocal = "fov"\n'
    )
    assert shell("run", report, "--config", "run.toml")[0] == 0
    words = ["--out", "here", "--methods", "conventional", "--jobs", 1, "--option", "conventional.focal=fov"]
    assert shell("run", report, *words)[0] == 0
    here, there = (pd.read_parquet(tmp_path / name / "results.parquet") for name in ("here", "there"))
    pd.testing.assert_frame_equal(here, there)
    assert here["options"][0] == '{"focal":"fov"}'


def test_a_run_in_which_nothing_was_measured_ends_with_3(shell: Shell, tmp_path: Path) -> None:
    refuses = write_method(tmp_path, "refuses", "raise rb.Unsupported('an epipole')")
    code, out, err = shell("run", write_report_file(tmp_path), "--methods", refuses, "--jobs", "1")
    assert code == 3
    assert "nothing was measured" in err
    assert "an epipole" in err
    assert "unsupported" in out


def test_render_and_rectify_go_together(shell: Shell, tmp_path: Path) -> None:
    wall, out = write_scene(tmp_path, "wall"), tmp_path / "pair"
    words = ["--width", 160, "--spp", 4, "--quality", "fast", "--motion", "sideways"]
    assert shell("render", wall, "t265", "-o", out, *words)[0] == 0
    assert {"left.png", "right.png", "truth.npz", "rig.yaml"} <= {file.name for file in out.iterdir()}
    assert list(out.glob("*.exr"))
    rig = rb.load_rig(out / "rig.yaml")
    assert rig.left.width == 160
    code, printed, _ = shell(
        "rectify", out / "left.png", out / "right.png", "--rig", out / "rig.yaml", "-o", tmp_path / "rect"
    )
    assert code == 0
    written = {file.name for file in (tmp_path / "rect").iterdir()}
    assert {Path(line).name for line in printed.splitlines() if str(tmp_path) in line} == written
    maps = np.load(tmp_path / "rect" / "maps.npz")
    left = cv2.imread(str(out / "left.png"))
    rectified = cv2.imread(str(tmp_path / "rect" / "left.png"))
    again = cv2.remap(left, maps["map_x_left"], maps["map_y_left"], cv2.INTER_LINEAR)
    assert np.array_equal(rectified, again)
    code, _, err = shell(
        "rectify", out / "left.png", out / "right.png", "--rig", "t265", "-o", tmp_path / "wrong"
    )
    assert code == 2
    assert "expected 848x800" in err
    assert not (tmp_path / "wrong").exists()


def test_help_names_every_verb_and_imports_no_heavy_package() -> None:
    code = """
import runpy, sys
sys.argv = ["rectbench", "--help"]
try:
    runpy.run_module("rectbench", run_name="__main__")
finally:
    print(*sys.modules, file=sys.stderr)
"""
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    verbs = ("list", "run", "report", "gate", "compare", "plan", "render", "rectify", "check", "doctor", "gc")
    for verb in verbs:
        assert re.search(rf"\b{verb}\b", done.stdout)
    imported = set(done.stderr.split())
    assert "rectbench.cli" in imported
    assert imported.isdisjoint(
        {"numpy", "scipy", "cv2", "pandas", "pyarrow", "matplotlib", "mitsuba", "drjit"}
    )


@pytest.mark.parametrize(
    "verb", ["list", "run", "report", "gate", "compare", "plan", "render", "rectify", "check", "gc"]
)
def test_every_verb_has_help(shell: Shell, verb: str) -> None:
    code, out, _ = shell(verb, "--help")
    assert code == 0
    assert "Usage" in out
