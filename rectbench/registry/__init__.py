"""The one loader of plugins and what their keys cover. Knows no kind of plugin; imports store and errors."""

from rectbench.registry.kind import Kind as Kind
from rectbench.registry.kind import Plugin as Plugin
from rectbench.registry.loading import Registry as Registry
from rectbench.registry.loading import forget_plugins as forget_plugins
from rectbench.registry.loading import is_path as is_path
from rectbench.registry.loading import registry as registry
