"""Public calibrations that say the same thing twice: what is read by the one agrees with the other."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
import yaml

from rectbench import load_rig
from tests.calibrations.calibration_files import opencv_file


def matrix(*numbers: float, rows: int = 3) -> np.ndarray:
    return np.array(numbers).reshape(rows, -1)


# extrinsics.yml of github.com/thaytan/stereo-calibration: R and T, and what cv2.stereoRectify made of them.
THAYTAN = {
    "K1": matrix(
        832.89082804522070, 0, 579.62271802834255, 0, 832.15124745952642, 471.90969136611682, 0, 0, 1
    ),
    "K2": matrix(
        833.94269118382397, 0, 582.03405440627705, 0, 833.75969969396738, 463.79832252132331, 0, 0, 1
    ),
    "D1": matrix(-0.36722305775, 0.15576654242, 2.0416339758e-4, 6.2256945618e-4, -0.03360812294, rows=1),
    "D2": matrix(-0.37178521691, 0.17294340711, 1.4186349262e-3, -6.5104838970e-4, -0.04344694963, rows=1),
    "R": matrix(
        *(0.99995837077268279, -2.3108795368062762e-04, 9.1215853884921948e-03),
        *(3.5753670422179951e-04, 0.99990383467852073, -1.3863389293193780e-02),
        *(-9.1175045460380674e-03, 1.3866073472586586e-02, 0.99986229207691679),
    ),
    "T": matrix(-59.835947362699066, 0.023205250763192315, -0.40240075032462863),
}
THAYTAN_R1 = matrix(
    *(0.99987423093476058, -5.2560300837716835e-04, 1.5850743014084876e-02),
    *(6.3547538554270034e-04, 0.99997580303622602, -6.9274463613281058e-03),
    *(-1.5846718387582490e-02, 6.9366478599027590e-03, 0.99985037102199059),
)
THAYTAN_R2 = matrix(
    *(0.99997731230951015, -3.8780574742088274e-04, 6.7249143452425509e-03),
    *(3.4117727563065151e-04, 0.99997590513314549, 6.9334516089104735e-03),
    *(-6.7274411417101955e-03, -6.9309999169511844e-03, 0.99995335029982069),
)
THAYTAN_P2 = (548.37466739758861, -32813.262190576272)


def test_a_stereo_calibration_of_opencv_s_and_its_rectification(tmp_path: Path) -> None:
    (tmp_path / "extrinsics.yml").write_text(opencv_file(**THAYTAN))
    rig = load_rig(tmp_path / "extrinsics.yml", size=(1280, 960), unit="mm")
    np.testing.assert_allclose(rig.R_right_left, THAYTAN_R2.T @ THAYTAN_R1, atol=1e-12)
    focal, shift = THAYTAN_P2
    np.testing.assert_allclose(
        THAYTAN_R1 @ rig.centre_right_in_left, [-shift / focal / 1000, 0, 0], atol=1e-9
    )


# config/rs_t265/kalibr_imucam_chain.yaml of OpenVINS.
OPENVINS_T_CAM_IMU = (
    [
        [-0.9998761771972654, 0.002831174545748783, 0.015479493663382282, 0.009847737933630705],
        [-0.0029326606695474597, -0.999974330610803, -0.0065374016913607265, 0.004044777973851876],
        [0.015460587788970944, -0.006581988314211809, 0.9998588138607628, -0.015241042987496874],
        [0.0, 0.0, 0.0, 1.0],
    ],
    [
        [-0.9999406689745719, 0.000724075187245526, 0.010868957898945571, -0.052814022762086264],
        [-0.0008072860689765681, -0.9999703864793142, -0.00765339490774561, 0.0040117609094788035],
        [0.010863094397485106, -0.007661715182273837, 0.9999116417466981, -0.015518593201262289],
        [0.0, 0.0, 0.0, 1.0],
    ],
)
OPENVINS_T_CN_CNM1 = [
    [0.999987149466532, 0.0021373753273530643, -0.004597012998122464, -0.06274034262839549],
    [-0.002142375274127713, 0.9999971186631936, -0.0010830020732420377, -2.841394090416243e-05],
    [0.0045946849706689046, 0.0010928366830696733, 0.9999888472268076, -0.00032738772888446857],
    [0.0, 0.0, 0.0, 1.0],
]
# config/camchain-imucam-fla.yaml of msckf_vio, whose matrices are flat lists.
FLA_T_CAM_IMU = (
    [
        *(0.9999354187625251, -0.008299416281612066, 0.007763890364879687, 0.1058254769257812),
        *(-0.008323202950480819, -0.9999607512746784, 0.003036478688450292, -0.017679034754829417),
        *(
            0.0077383846414136375,
            -0.0031009030240912025,
            -0.9999652502980172,
            -0.008890355463642424,
            0,
            0,
            0,
            1,
        ),
    ],
    [
        *(0.9999415499962613, -0.003314180239269491, 0.010291394483555276, -0.09412457355264209),
        *(-0.0029741561536762054, -0.9994548489877669, -0.032880985843089204, -0.016816910884051604),
        *(0.010394757632964142, 0.03284845573511056, -0.9994062877376598, -0.008908185988981819, 0, 0, 0, 1),
    ],
)
FLA_T_CN_CNM1 = [
    *(0.9999843700393054, -0.004977416649937181, -0.0025428275521419763, -0.200059),
    *(0.005065643350062822, 0.9993405242433947, 0.03595604029590122, 0.000634053),
    *(0.002362182447858024, -0.03596835970409878, 0.9993501279159637, -0.000909473, 0, 0, 0, 1),
]


@pytest.mark.parametrize(
    ("T_cam_imu", "T_cn_cnm1"),
    [(OPENVINS_T_CAM_IMU, OPENVINS_T_CN_CNM1), (FLA_T_CAM_IMU, FLA_T_CN_CNM1)],
    ids=["openvins", "msckf"],
)
def test_a_chain_and_the_poses_of_its_cameras_in_the_imu(
    tmp_path: Path, T_cam_imu: tuple[list, list], T_cn_cnm1: list
) -> None:
    camera = {"camera_model": "pinhole", "distortion_model": "equidistant", "resolution": [848, 800]}
    camera |= {
        "intrinsics": [282.02, 280.715, 415.956, 396.661],
        "distortion_coeffs": [-3e-3, 0.054, -0.05, 0.01],
    }
    rigs = []
    for name, poses in (
        ("chain", [{}, {"T_cn_cnm1": T_cn_cnm1}]),
        ("imu", [{"T_cam_imu": T} for T in T_cam_imu]),
    ):
        path = tmp_path / f"{name}.yaml"
        path.write_text(yaml.safe_dump({f"cam{n}": camera | pose for n, pose in enumerate(poses)}))
        rigs.append(load_rig(path))
    # Kalibr estimates both; they agree as far as its last iteration went.
    np.testing.assert_allclose(rigs[0].R_right_left, rigs[1].R_right_left, atol=1e-6)
    np.testing.assert_allclose(rigs[0].t_right_left, rigs[1].t_right_left, atol=1e-5)


# examples/StereoDepth/depthai_calib.json of depthai-python: CAM_B to CAM_C, CAM_C to CAM_A.
OAK_POSES = {
    1: (
        2,
        [
            [0.999877393245697, -0.003816623007878661, 0.0151876425370574],
            [0.0037984729278832674, 0.9999920129776001, 0.001223734114319086],
            [-0.015192192047834396, -0.00116589420940727, 0.9998838901519775],
        ],
        [-7.378519058227539, 0.06277830898761749, 0.047404833137989044],
        [-7.5, 0.0, 0.0],
    ),
    2: (
        0,
        [
            [0.9999580979347229, 0.004886251874268055, -0.007745699025690556],
            [-0.004901527892798185, 0.9999861121177673, -0.0019543941598385572],
            [0.00773604167625308, 0.001992278266698122, 0.9999680519104004],
        ],
        [3.6778411865234375, -0.020332952961325645, -0.08972050994634628],
        [3.75, 0.0, 0.0],
    ),
    0: (-1, [], [0.0, 0.0, 0.0], [0.0, 0.0, 0.0]),
}


@pytest.mark.parametrize(("pair", "spec_m"), [(("CAM_B", "CAM_C"), 0.075), (("CAM_B", "CAM_A"), 0.0375)])
def test_an_oak_s_cameras_stand_where_its_board_has_them(
    tmp_path: Path, pair: tuple[str, str], spec_m: float
) -> None:
    K = [[582.4674177512317, 0, 666.2853476539666], [0, 581.730471436289, 387.7735823361715], [0, 0, 1]]
    cameras = []
    for socket, (to, R, t, spec) in OAK_POSES.items():
        extrinsics = {"rotationMatrix": R, "toCameraSocket": to}
        extrinsics |= {"translation": dict(zip("xyz", t, strict=True))}
        extrinsics |= {"specTranslation": dict(zip("xyz", spec, strict=True))}
        camera = {"cameraType": 0, "width": 1280, "height": 720, "intrinsicMatrix": K}
        cameras.append([socket, camera | {"distortionCoeff": [0.0] * 14, "extrinsics": extrinsics}])
    (tmp_path / "calib.json").write_text(json.dumps({"cameraData": cameras}))
    rig = load_rig(tmp_path / "calib.json", cameras=pair)
    np.testing.assert_allclose(rig.centre_right_in_left, [spec_m, 0, 0], atol=2e-3)
