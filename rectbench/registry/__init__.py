"""The one loader of plugins and what their keys cover. Knows no kind of plugin; imports store and errors."""

from rectbench.registry.kind import Kind, Plugin
from rectbench.registry.loading import Registry, forget_plugins, is_path, registry

__all__ = ["Kind", "Plugin", "Registry", "forget_plugins", "is_path", "registry"]
