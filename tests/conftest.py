"""Property tests draw the same examples in every run, whatever the machine's speed."""

from hypothesis import settings

settings.register_profile("rectbench", derandomize=True, deadline=None)
settings.load_profile("rectbench")
