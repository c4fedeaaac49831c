"""Which instructions are in a program or library: those that fuse, and those that not all have."""

from __future__ import annotations

import re
import subprocess
from pathlib import Path

# A product and a sum in one, on x86 and on ARM.
FUSED = re.compile(r"\s(?:vfn?m(?:add|sub)\w+|fn?m(?:add|sub)|fml[as])\s")
# AVX and later, whose names begin with v; SSE3 to SSE4.2, by names that compilers choose; and those
# on bits that came with them, but for tzcnt, which older processors take as bsf.
BEYOND_SSE2 = re.compile(
    r"\s(?:v[a-z]\w+|pshufb|palign\w+|pabs[bwd]|p(?:max|min)(?:s[bd]|u[wd])|pblend\w+|blend\w+"
    r"|round[sp][sd]|dpp[sd]|movddup|mov[sh]ldup|h(?:add|sub)p[sd]|addsubp[sd]|pmulld|pmuldq"
    r"|pcmpeqq|pcmpgtq|ptest|pextr[bdq]|pinsr[bdq]|insertps|extractps|popcnt\w?|crc32\w?|lzcnt\w?"
    r"|mulx\w?|andn\w?|[rs]orx|s[ah][lr]x|pdep|pext)\s"
)


def listed(binary: Path, objdump: str = "objdump") -> str:
    """Disassemble a program or library."""
    command = [objdump, "--disassemble", "--no-show-raw-insn", str(binary)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def fused(binary: Path, objdump: str = "objdump") -> int:
    """Count instructions that round once where the source rounds twice."""
    return len(FUSED.findall(listed(binary, objdump)))


def beyond_sse2(binary: Path) -> set[str]:
    """List instructions that an x86-64 processor need not have."""
    return {found.strip() for found in BEYOND_SSE2.findall(listed(binary))}
