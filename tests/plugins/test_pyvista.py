"""What is said where PyVista is missing or too old; with it, `scripts/check_hosts.sh` tests."""

from __future__ import annotations

import importlib
import sys
from types import SimpleNamespace

import pytest

from liftmesh import MissingDependencyError


@pytest.mark.parametrize(
    ("host", "message"),
    [
        (None, r"this needs pyvista, .*: pip install 'liftmesh\[pyvista\]'"),
        (
            SimpleNamespace(__version__="0.47.3"),
            r"PyVista 0.47.3 is older than 0.48: pip install -U 'liftmesh\[pyvista\]'",
        ),
    ],
)
def test_no_pyvista(host: object, message: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setitem(sys.modules, "pyvista", host)
    monkeypatch.delitem(sys.modules, "liftmesh.plugins.pyvista", raising=False)
    with pytest.raises(MissingDependencyError, match=message):
        importlib.import_module("liftmesh.plugins.pyvista")
