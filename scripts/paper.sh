#!/usr/bin/env bash
# The paper's tables and figures on a fresh machine: installs liftmesh into .venv-paper and measures.
#   scripts/paper.sh             both tables in full, into data/paper: about a quarter of an hour
#   scripts/paper.sh --quick     small sizes, into out/paper-quick: under a minute
# An interrupted run resumes where it stopped; other options are those of `liftmesh paper`.
set -euo pipefail
cd -- "$(dirname -- "${BASH_SOURCE[0]}")/.."
source scripts/setup.sh

environment=.venv-paper

# The tables in the repository come from one machine; only a full run on another replaces them.
replace_committed() {
    mkdir -p data/paper
    cp out/paper/*.csv out/paper/*.json out/paper/*.md data/paper/
    cp out/paper/figures/{figure_4_3,figure_6_1,figure_6_2,rejections,power_diagram,metric,farthest,disks,stars,adaptive_thinning}.png data/paper/
    say
    say "data/paper holds the tables of this machine, out/paper/figures all figures."
}

prepare_machine build
# Editable, so that Python started in this folder finds the kernel and not the bare sources.
make_environment $environment "pyproject.toml README.md LICENSE liftmesh" --editable '.[cli,plot]'
mkdir -p out

if (($# == 0)); then
    show liftmesh paper --out out/paper
    replace_committed
else
    show liftmesh paper "$@"
fi
