"""Dense matchers along the rows of rectified images, one file each. Imports what a matcher is, and below."""

from rectbench.matching.dense.matchers import bm as bm
from rectbench.matching.dense.matchers import ncc as ncc
from rectbench.matching.dense.matchers import sgbm as sgbm
