"""rectbench: a bench for stereo rectification, fisheye first.

The public names are those of `__init__.pyi`. Each is imported when first used, so that
``import rectbench`` is quick and needs neither Mitsuba nor OpenCV.
"""

import lazy_loader

__version__ = "0.1.0"

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
