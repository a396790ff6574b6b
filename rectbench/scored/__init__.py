"""What a rectification is scored on: pixels, shares of the view, the delivered map. Imports warps and
below."""

from rectbench.scored.agreement import check_agreement as check_agreement
from rectbench.scored.delivered import Delivered as Delivered
from rectbench.scored.delivered import DeliveredSide as DeliveredSide
from rectbench.scored.seen import SeenPixels as SeenPixels
from rectbench.scored.seen import SeenView as SeenView
from rectbench.scored.seen import dense_pixels as dense_pixels
from rectbench.scored.view import SHARES as SHARES
from rectbench.scored.view import ScoredPixels as ScoredPixels
from rectbench.scored.view import ScoredView as ScoredView
