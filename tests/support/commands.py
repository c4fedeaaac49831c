"""Running the command line as a person or a script does: a process, its pipes, its terminal."""

from __future__ import annotations

import errno
import io
import os
import pty
import re
import signal
import subprocess
import sys
import time
from contextlib import redirect_stderr, redirect_stdout
from pathlib import Path

from liftmesh.cli import main

ROOT = Path(__file__).resolve().parents[2]
TERRAIN = ROOT / "data" / "jacksboro.ply"
COMMAND = [sys.executable, "-m", "liftmesh"]
ESCAPES = re.compile(r"\x1b\[[0-9;?]*[A-Za-z]")

PLAIN = {
    name: value for name, value in os.environ.items() if name not in {"NO_COLOR", "FORCE_COLOR"}
}


def liftmesh(*words, cwd=None):
    """Run the command in this process; return its streams and exit code like `process`."""
    out, err, here = io.StringIO(), io.StringIO(), Path.cwd()
    os.chdir(cwd or here)
    try:
        with redirect_stdout(out), redirect_stderr(err):
            code = main([*map(str, words)])
    finally:
        os.chdir(here)
    return subprocess.CompletedProcess(words, code, out.getvalue(), err.getvalue())


def process(*words, cwd=None, stdin=None, text=True, env=()):
    """Run the command in a process of its own, with pipes for all its streams."""
    return subprocess.run(
        [*COMMAND, *map(str, words)],
        cwd=cwd,
        input=stdin,
        capture_output=True,
        text=text,
        env={**PLAIN, **dict(env)},
        timeout=300,
        check=False,
    )


def on_terminal(*words, cwd=None, env=()):
    """Run the command on a terminal of its own; return what it shows and its exit code."""
    outer, inner = pty.openpty()
    process = subprocess.Popen(
        [*COMMAND, *map(str, words)],
        cwd=cwd,
        stdin=inner,
        stdout=inner,
        stderr=inner,
        env={**PLAIN, "TERM": "xterm-256color", "COLUMNS": "100", **dict(env)},
    )
    os.close(inner)
    shown = b"".join(_chunks(outer))
    os.close(outer)
    return shown.decode(), process.wait(timeout=300)


def _chunks(stream):
    while True:
        try:
            chunk = os.read(stream, 65536)
        except OSError as error:  # Linux reports a closed terminal as an error
            if error.errno != errno.EIO:
                raise
            return
        if not chunk:
            return
        yield chunk


def interrupted(*words, cwd=None):
    """Press Ctrl-C amid the work; return its exit code and streams."""
    process = subprocess.Popen(
        [*COMMAND, *map(str, words)],
        cwd=cwd,
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        env=PLAIN,
    )
    while b"_kernel" not in Path(f"/proc/{process.pid}/maps").read_bytes():
        time.sleep(0.01)
    begin = computed(process)
    while process.poll() is None and computed(process) < begin + 0.3:
        time.sleep(0.005)
    assert process.poll() is None, "it ended before Ctrl-C: give it more to do"
    process.send_signal(signal.SIGINT)
    out, err = process.communicate(timeout=300)
    return process.returncode, out, err


def computed(process):
    """The seconds of the processor that a process has used, however busy the machine is."""
    fields = Path(f"/proc/{process.pid}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


def without_escapes(text):
    return ESCAPES.sub("", text).replace("\r", "")


def failed(done, code, *parts):
    """One line on stderr that holds all parts, nothing on stdout, and the exit code."""
    assert done.returncode == code, done.stderr
    assert done.stdout == ""
    assert done.stderr.startswith("liftmesh: error: ")
    assert done.stderr.count("\n") == 1
    assert not {"\ufdd0", "\ufdd1"} & {*done.stderr}  # the marks of options
    for part in parts:
        assert part in done.stderr


def handlers() -> tuple[object, ...]:
    here = [signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)]
    wakeup = signal.set_wakeup_fd(-1)
    return *here, wakeup, sys.unraisablehook
