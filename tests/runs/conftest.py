"""Each test has a store of its own and loads plugins anew."""

from tests.isolation import store as store
