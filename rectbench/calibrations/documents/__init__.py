"""Files as text and plain data: JSON, YAML, XML, lists of numbers. Imports `rigs.rig` and what is below."""

from rectbench.calibrations.documents.faults import errors_at as errors_at
from rectbench.calibrations.documents.faults import one_line as one_line
from rectbench.calibrations.documents.faults import shown as shown
from rectbench.calibrations.documents.numbers import agreed_size as agreed_size
from rectbench.calibrations.documents.numbers import checked_size as checked_size
from rectbench.calibrations.documents.numbers import finite_number as finite_number
from rectbench.calibrations.documents.sections import Section as Section
from rectbench.calibrations.documents.sections import parse_document as parse_document
from rectbench.calibrations.documents.sources import Source as Source
from rectbench.calibrations.documents.telling import tell as tell
from rectbench.calibrations.documents.telling import telling as telling
