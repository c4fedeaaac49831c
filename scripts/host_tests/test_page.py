"""The examples of plugins.md for PyVista, as `tests/test_pages.py` runs the others."""

from __future__ import annotations

import doctest
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FLAGS = doctest.ELLIPSIS | doctest.NORMALIZE_WHITESPACE


def test_examples(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(ROOT)
    page = (ROOT / "docs/guide/plugins.md").read_text("utf-8")
    _, _, rest = page.partition("\n## PyVista\n")
    parts = re.findall(
        r"^```pycon\n(.*?)^```$", rest.partition("\n## ")[0], re.MULTILINE | re.DOTALL
    )
    examples = doctest.DocTestParser().get_doctest("\n".join(parts), {}, "PyVista", None, 0)
    assert len(examples.examples) > 15
    told: list[str] = []
    result = doctest.DocTestRunner(optionflags=FLAGS).run(examples, out=told.append)
    assert result.failed == 0, "".join(told)
