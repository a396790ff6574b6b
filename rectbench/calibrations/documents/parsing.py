"""YAML, JSON, XML and TOML as plain strings, lists and mappings, from files that are not trusted.

Nothing here constructs an object or expands an entity, and what may be nested and counted is bounded, with
what an alias repeats counted again, so that a small file cannot become a long wait or a full memory.
"""

from __future__ import annotations

import json
import re
import tomllib
from typing import Any
from xml.parsers import expat

import yaml

from rectbench.calibrations.documents.entries import Entries, as_entries

MAX_CHARACTERS = 1 << 21
"""A longer text takes the parsers of JSON and XML a second, and a hundred megabytes."""

MAX_YAML_CHARACTERS = 1 << 20
MAX_TOML_CHARACTERS = 1 << 18
MAX_VALUES = 60_000
"""Values in a file; stereo calibrations that keep every image point of their board have some ten thousand."""

MAX_KEY = 200
"""Characters of a key."""

MAX_DEPTH = 40
"""Lists and mappings inside each other; calibrations have five."""

PLAIN_TAGS = {f"tag:yaml.org,2002:{kind}" for kind in ("str", "seq", "map", "int", "float", "null", "bool")}
OPENCV_TAGS = {
    f"{prefix}opencv-{kind}" for prefix in ("tag:yaml.org,2002:", "!") for kind in ("matrix", "nd-matrix")
}
"""Tags of a mapping with rows, cols and data, which is all that they say."""

TAGS = {*PLAIN_TAGS, *OPENCV_TAGS, "!"}
NODES = {yaml.AliasEvent, yaml.ScalarEvent, yaml.SequenceStartEvent, yaml.MappingStartEvent}

# Possessive, so that a long file of blank lines is scanned once.
TOML = re.compile(r"(?:\s++|#[^\n]*+)*+(?:\[[\w.\"-]++\][ \t]*+(?:#[^\n]*+)?+\r?+\n|[\w-]++ = )")
"""How a TOML file begins: a table's name alone in its line, or `key = `."""

DOTTED = re.compile(
    r"""(?<![\w-])(?:(?:[\w-]{1,60}+|"(?:[^"\\\n]|\\.){0,60}+"|'[^'\n]{0,60}+')[ \t]{0,9}+\.[ \t]{0,9}+){8}"""
)
"""A key of more parts than tables have; Python's parser takes the square of their number in memory."""

LOADER: Any = getattr(yaml, "CBaseLoader", yaml.BaseLoader)


class Malformed(ValueError):
    """What is wrong with a text, in words that follow the name of its file."""


def parse(text: str) -> Any:
    """A YAML, JSON, XML or TOML text as plain data; its numbers are still strings in YAML and XML.

    Raises Malformed, with the line at which the text ends making sense.
    """
    if len(text) > MAX_CHARACTERS:
        raise Malformed(f"is larger than {MAX_CHARACTERS >> 10} KiB")
    reader = {"{": _json_or_yaml, "[": _json_or_yaml, "<": _xml}.get(text.lstrip()[:1], _yaml)
    reader = _toml if TOML.match(text) else reader
    try:
        return reader(text)
    except RecursionError:
        raise Malformed("is nested too deeply") from None


def _json_or_yaml(text: str) -> Any:
    """JSON; or YAML, whose mappings may have braces too, where it is none."""
    try:
        return _json(text)
    except Malformed as error:
        try:
            return _yaml(text)
        except Malformed as other:
            raise (other if str(other).startswith("has over") else error) from None


def _json(text: str) -> Any:
    # OpenCV writes NaN and infinity as no JSON does.
    text = re.sub(r"(?<=[\s,\[:])(-?)\.(Nan|Inf)(?=[\s,\]])", r"\1NaN", text)
    try:
        content = json.loads(text, object_pairs_hook=_mapping, parse_int=float)
    except json.JSONDecodeError as error:
        raise Malformed(f"is no JSON at line {error.lineno} ({error.msg})") from None
    except OverflowError as error:
        raise Malformed(f"is no JSON ({error})") from None
    _check_depth(content)
    return content


def _check_depth(content: Any) -> None:
    level = [content]
    for _ in range(MAX_DEPTH):
        children = (item.values() if isinstance(item, dict) else item for item in level)
        level = [child for items in children for child in items if isinstance(child, list | dict)]
        if not level:
            return
    raise Malformed("is nested too deeply")


def _yaml(text: str) -> Any:
    if len(text) > MAX_YAML_CHARACTERS:
        raise Malformed(f"is larger than {MAX_YAML_CHARACTERS >> 10} KiB")
    try:
        documents = _yaml_documents(_as_yaml(text))
    except yaml.MarkedYAMLError as error:
        where = f" at line {error.problem_mark.line + 1}" if error.problem_mark else ""
        raise Malformed(f"is no YAML{where} ({error.problem})") from None
    except (yaml.YAMLError, ValueError, OverflowError) as error:
        raise error if isinstance(error, Malformed) else Malformed(f"is no YAML ({error})") from None
    filled = [document for document in documents if document != ""]  # ROS ends a message with ---
    if any(_message(document) != _message(filled[0]) for document in filled[1:]):
        raise Malformed("holds several YAML documents")
    return filled[0] if filled else ""


def _message(document: Any) -> Any:
    """What a ROS topic says again and again, each time with another number and time in its header."""
    if not isinstance(document, dict):
        return document
    return {key: value for key, value in document.items() if key != "header"}


def _as_yaml(text: str) -> str:
    """OpenCV's dialect as YAML: a directive of its own, and keys with no space after their colon."""
    if not re.match(r"\s*%YAML", text):
        return text
    body = re.sub(r"\A\s*%YAML[^\n]*", "", text)
    body = re.sub(r"(?m)^([ \t]*[\w.-]+):(?=[^\s:/])", r"\1: ", body)
    return re.sub(r"([{,][ \t]*[\w.-]+):(?=[^\s:/])", r"\1: ", body)


def _yaml_documents(text: str) -> list[Any]:
    stack: list[list[Any]] = [[]]
    starts: list[Any] = []
    anchors: dict[str, Any] = {}
    count = 0
    events: Any = yaml.parse(text, Loader=LOADER)
    for event in events:
        kind = type(event)
        count += 1
        if kind is yaml.DocumentStartEvent:
            anchors.clear()
        if kind in NODES:
            _check_tag(event)
        if kind is yaml.ScalarEvent:
            _add(event.value, event.anchor, stack, anchors)
        elif kind is yaml.AliasEvent:
            value = _named(event, anchors)
            size, height = _extent(value)
            count += size
            if len(stack) + height > MAX_DEPTH:
                raise Malformed("is nested too deeply")
            stack[-1].append(value)
        elif kind in (yaml.SequenceStartEvent, yaml.MappingStartEvent):
            if len(stack) > MAX_DEPTH:
                raise Malformed("is nested too deeply")
            stack.append([])
            starts.append(event)
        elif kind in (yaml.SequenceEndEvent, yaml.MappingEndEvent):
            items, start = stack.pop(), starts.pop()
            whole = items if kind is yaml.SequenceEndEvent else _yaml_mapping(items, start)
            _add(whole, start.anchor, stack, anchors)
        if count > MAX_VALUES:
            raise Malformed(f"has over {MAX_VALUES} values")
    return stack[0]


def _add(value: Any, anchor: str | None, stack: list[list[Any]], anchors: dict[str, Any]) -> None:
    stack[-1].append(value)
    if anchor is not None:
        anchors[anchor] = value


def _named(alias: Any, anchors: dict[str, Any]) -> Any:
    """What an alias repeats; PyYAML writes one where two cameras share a list, such as the resolution."""
    if alias.anchor not in anchors:
        raise yaml.MarkedYAMLError(problem="an alias of nothing before it", problem_mark=alias.start_mark)
    return anchors[alias.anchor]


def _extent(value: Any) -> tuple[int, int]:
    """How many values there are inside a value, itself counted, and how deep they are nested."""
    if not isinstance(value, list | dict):
        return 1, 0
    extents = [_extent(item) for item in (value.values() if isinstance(value, dict) else value)]
    return 1 + sum(size for size, _ in extents), 1 + max((height for _, height in extents), default=0)


def _check_tag(event: Any) -> None:
    tag = None if isinstance(event, yaml.AliasEvent) else event.tag
    if tag is not None and tag not in TAGS:
        raise yaml.MarkedYAMLError(problem=f"the tag {tag[:60]}", problem_mark=event.start_mark)


def _yaml_mapping(items: list[Any], start: Any) -> dict[str, Any]:
    try:
        return _mapping(list(zip(items[::2], items[1::2], strict=True)))
    except Malformed as error:
        raise yaml.MarkedYAMLError(problem=str(error), problem_mark=start.start_mark) from None


def _mapping(pairs: list[tuple[Any, Any]]) -> dict[str, Any]:
    mapping = Entries()
    for key, value in pairs:
        if not isinstance(key, str) or len(key) > MAX_KEY:
            raise Malformed("has a key that is no word")
        if key == "<<":
            raise Malformed("merges mappings with <<")
        if key in mapping:
            raise Malformed(f"has the key {key[:40]} twice")
        mapping[key] = value
    return mapping


def _toml(text: str) -> Any:
    if len(text) > MAX_TOML_CHARACTERS:
        raise Malformed(f"is larger than {MAX_TOML_CHARACTERS >> 10} KiB")
    if DOTTED.search(text):
        raise Malformed("has a key of over 8 parts")
    try:
        content = tomllib.loads(text)
    except ValueError as error:  # also a number of more digits than Python takes
        raise Malformed(f"is no TOML ({error})") from None
    _check_depth(content)
    return as_entries(content)


def _xml(text: str) -> Any:
    """`<key>value</key>` as OpenCV writes it: children `_` are a list, words apart another."""
    reader = _XmlReader()
    parser = expat.ParserCreate(encoding="utf-8")
    parser.buffer_text = True
    parser.StartDoctypeDeclHandler = reader.doctype
    parser.StartElementHandler = reader.start
    parser.EndElementHandler = reader.end
    parser.CharacterDataHandler = reader.characters
    try:
        parser.Parse(text.encode(), True)
    except expat.ExpatError as error:
        raise Malformed(f"is no XML at line {error.lineno} ({expat.ErrorString(error.code)})") from None
    return reader.root


class _XmlReader:
    def __init__(self) -> None:
        self.root: Any = ""
        self.count = 0
        self.open: list[tuple[str, list[tuple[str, Any]], list[str]]] = []

    def doctype(self, *_: Any) -> None:
        raise Malformed("declares a document type, with which entities come")

    def start(self, name: str, _: dict[str, str]) -> None:
        self.count += 1
        if self.count > MAX_VALUES or len(self.open) > MAX_DEPTH:
            raise Malformed(
                "is nested too deeply" if self.count <= MAX_VALUES else f"has over {MAX_VALUES} values"
            )
        self.open.append((name, [], []))

    def characters(self, text: str) -> None:
        self.open[-1][2].append(text)

    def end(self, _: str) -> None:
        name, children, words = self.open.pop()
        value: Any = _leaf("".join(words))
        if children:
            is_list = all(key == "_" for key, _ in children)
            value = [child for _, child in children] if is_list else _mapping(children)
        if self.open:
            self.open[-1][1].append((name, value))
        else:
            self.root = value


def _leaf(text: str) -> Any:
    text = text.strip()
    if text.startswith('"'):
        return text.strip('"')
    words = text.split()
    return words if len(words) > 1 else text
