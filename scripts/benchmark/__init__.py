"""Time, memory and exactness of liftmesh and of the programs a Python user could install instead.

A case is one input and its contestants. A contestant is a peer (a program) on a number of threads,
and runs in a fresh process. Its first run, the trial, measures time and memory; its triangles are
checked exactly before its times count. Then all contestants are timed in alternating rounds.

    tasks/        the benchmarks of `scripts/bench.py`; `delaunay` is the one described above
    measuring     options, calls in turn, fresh processes and tables of all tasks
    cases         the cases that each profile of the command measures
    contest       one case: the trials, then the rounds
    contestants   a peer on a number of threads, and its process
    peers         the programs, and how each is called
    worker        the process of a Python peer; cgal/ is the same in C++
    process       requests to a process and its answers, with a time limit
    results       medians, ratios, the best exact peer
    targets       the performance targets, and what was reached
    tables, records, plots   results in the terminal, as JSON and as pictures
    startup       the cost of importing
    system_load   processor time that other programs took meanwhile
    profile/      instruction counts of the kernel

The check of triangles is `oracles/second_opinion.py`.
"""
