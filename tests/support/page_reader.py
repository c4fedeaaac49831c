"""What a page holds, read as a browser and its script read it."""

from __future__ import annotations

import base64
import json
import zlib
from html.parser import HTMLParser

import numpy as np

TYPES = {"f8": np.float64, "f4": np.float32, "i4": np.int32, "u1": np.uint8}


class Elements(HTMLParser):
    """The elements of a page with their texts, as a browser finds them."""

    def __init__(self, text):
        super().__init__(convert_charrefs=True)
        self.found = []
        self.feed(text)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.found.append((tag, dict(attrs), ""))

    def handle_endtag(self, tag):
        self.found.append((f"/{tag}", {}, ""))

    def handle_data(self, data):
        if self.found:
            tag, attributes, text = self.found[-1]
            self.found[-1] = tag, attributes, text + data

    def named(self, name):
        (text,) = [text for _, attributes, text in self.found if attributes.get("id") == name]
        return text


def read(page):
    """The header of a page, with the arrays in their places."""
    elements = Elements(page.to_html())
    header = json.loads(elements.named("header"))
    data = base64.b64decode(elements.named("arrays"))
    found = []
    for each in header["arrays"]:
        kind = np.dtype(TYPES[each["type"]]).newbyteorder("<")
        planes = np.frombuffer(zlib.decompress(data[each["first"] : each["last"]]), np.uint8)
        array = np.ascontiguousarray(planes.reshape(kind.itemsize, -1).T).view(kind).reshape(-1)
        found.append(np.cumsum(array, dtype=np.int32) if each["type"] == "i4" else array)
        assert len(array) == each["length"]
    for layer in header["layers"]:
        for name in {"points", "cells", "neighbors", "rows", "colors"} & layer.keys():
            layer[name] = found[layer[name]]
        for value in layer["values"]:
            if "array" in value:
                value["array"] = found[value["array"]]
    return header
