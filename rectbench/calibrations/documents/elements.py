"""XML whose attributes and repeated elements count, from files that are not trusted."""

from __future__ import annotations

from xml.etree import ElementTree
from xml.etree.ElementTree import Element

from rectbench.calibrations.documents.parsing import MAX_CHARACTERS, MAX_DEPTH, Malformed

MAX_ELEMENTS = 60_000
"""Elements in a file; a photogrammetric project has some ten for each of its images."""


def parse_elements(text: str) -> Element:
    """The root element of an XML text; raises Malformed for another, for entities and for too much of it."""
    if len(text) > MAX_CHARACTERS:
        raise Malformed(f"is larger than {MAX_CHARACTERS >> 10} KiB")
    parser = ElementTree.XMLParser(target=_Builder())
    try:
        parser.feed(text)
        root: Element = parser.close()
    except ElementTree.ParseError as error:
        raise Malformed(f"is no XML ({error})") from None
    return root


class _Builder(ElementTree.TreeBuilder):
    """Refuses a document type, with which entities come, and counts what it builds."""

    def __init__(self) -> None:
        super().__init__()
        self.count = self.depth = 0

    def doctype(self, *_: object) -> None:
        raise Malformed("declares a document type, with which entities come")

    def start(self, tag: str, attrs: dict[str, str]) -> Element:
        self.count += 1
        self.depth += 1
        if self.depth > MAX_DEPTH:
            raise Malformed("is nested too deeply")
        if self.count > MAX_ELEMENTS:
            raise Malformed(f"has over {MAX_ELEMENTS} elements")
        return super().start(tag, attrs)

    def end(self, tag: str) -> Element:
        self.depth -= 1
        return super().end(tag)
